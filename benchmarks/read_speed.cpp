// SPDX-License-Identifier: BSD-3-Clause
// How fast are graph files read, from the page cache and on one thread? Usage: bench_read_speed
// [FILE...]; without files some public graphs and a generated planar one of a million poses.
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "benchmarks/support/measure.hpp"
#include "benchmarks/support/table.hpp"
#include "cairn/core/output_file.hpp"
#include "cairn/io/graph_file.hpp"

namespace cairn::bench {
namespace {

constexpr int kRounds = 9;

// Poses on a line with two edges each, all digits of a double, as our own writer leaves them.
std::string generate(int poses) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, 0.02);
  std::string text;
  const auto add = [&](double x) {
    char digits[32];
    digits[0] = ' ';
    text.append(digits, std::to_chars(digits + 1, digits + sizeof digits, x).ptr);
  };
  for (int i = 0; i < poses; ++i) {
    text += "VERTEX_SE2 " + std::to_string(i);
    for (int k = 0; k < 3; ++k) add(i + noise(random));
    text += '\n';
  }
  for (int i = 1; i < poses; ++i) {
    for (const int back : {1, 97}) {
      text += "EDGE_SE2 " + std::to_string(std::max(0, i - back)) + ' ' + std::to_string(i);
      for (int k = 0; k < 3; ++k) add(back + noise(random));
      text += " 500 0 0 500 0 2500\n";
    }
  }
  return text;
}

double seconds_to_read(const std::string& path) {
  const Stopwatch watch;
  const Result<GraphDocument> document = read_graph(path);
  return document ? watch.seconds() : std::nan("");
}

void measure(const std::string& path, const Table& table) {
  const auto bytes = static_cast<double>(std::filesystem::file_size(path));
  std::vector<double> seconds;
  for (int round = 0; round < kRounds; ++round) seconds.push_back(seconds_to_read(path));
  const double middle = median(seconds);
  table.row({std::filesystem::path(path).filename().string(), number_text(bytes / 1e6, 1) + " MB",
             time_text(middle), number_text(bytes / 1e6 / middle, 0) + " MB/s"});
}

std::vector<std::string> public_graphs() {
  const char* root = std::getenv("CAIRN_DATASETS");
  std::vector<std::string> paths;
  for (const char* name : {"pose2/intel.g2o", "pose2/city10000.g2o", "pose3/sphere2500.g2o",
                           "landmarks/victoriaPark.txt", "toro/sphere_smallnoise.graph"}) {
    const std::string path = std::string(root ? root : "../shared/datasets") + "/graphs/" + name;
    if (std::filesystem::exists(path)) paths.push_back(path);
  }
  return paths;
}

int run(std::vector<std::string> paths) {
  const Table table({"graph", "size", "time (median of 9)", "speed"});
  if (!paths.empty()) {
    for (const std::string& path : paths) measure(path, table);
    return 0;
  }
  for (const std::string& path : public_graphs()) measure(path, table);
  const std::string large =
      (std::filesystem::temp_directory_path() / "cairn_million_poses.g2o").string();
  if (!write_file(large, generate(1'000'000))) return 1;
  measure(large, table);
  std::filesystem::remove(large);
  return 0;
}

}  // namespace
}  // namespace cairn::bench

int main(int argc, char** argv) { return cairn::bench::run({argv + 1, argv + argc}); }
