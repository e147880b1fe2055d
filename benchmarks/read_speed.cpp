// SPDX-License-Identifier: BSD-3-Clause
// How fast are graph files read? Usage: read_speed [FILE...]; without files, a generated planar
// graph of a million poses. Reads each file from the page cache, one thread, and prints megabytes
// per second.
#include <time.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "cairn/core/output_file.hpp"
#include "cairn/io/graph_file.hpp"

namespace {

constexpr int kRuns = 9;

// Poses on a spiral with two edges each, all digits of a double, as our own writer leaves them.
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

// Processor time of this process: other programs on the machine do not count.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double seconds_to_read(const std::string& path) {
  const double start = processor_seconds();
  const auto document = cairn::read_graph(path);
  const double seconds = processor_seconds() - start;
  if (!document) {
    std::fprintf(stderr, "%s\n", document.error().to_string().c_str());
    std::exit(3);
  }
  return seconds;
}

void measure(const std::string& path) {
  const auto bytes = static_cast<double>(std::filesystem::file_size(path));
  std::vector<double> seconds;
  for (int i = 0; i < kRuns; ++i) seconds.push_back(seconds_to_read(path));
  std::sort(seconds.begin(), seconds.end());
  const double median = seconds[seconds.size() / 2];
  std::printf("%-60s %9.1f MB  median %8.2f ms (%6.1f MB/s)  best %8.2f ms (%6.1f MB/s)\n",
              path.c_str(), bytes / 1e6, 1e3 * median, bytes / 1e6 / median, 1e3 * seconds.front(),
              bytes / 1e6 / seconds.front());
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> paths(argv + 1, argv + argc);
  std::string generated;
  if (paths.empty()) {
    generated = (std::filesystem::temp_directory_path() / "cairn_read_speed.g2o").string();
    if (!cairn::write_file(generated, generate(1'000'000))) return 1;
    paths.push_back(generated);
  }
  for (const std::string& path : paths) measure(path);
  if (!generated.empty()) std::filesystem::remove(generated);
  return 0;
}
