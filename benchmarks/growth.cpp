// SPDX-License-Identifier: BSD-3-Clause
// How do time and memory grow with the graph? Simulated cities of 1e4, 1e5 and 1e6 poses with about
// two edges per pose, each read from a file and solved in a process of its own.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "benchmarks/support/child_process.hpp"
#include "benchmarks/support/graphs.hpp"
#include "benchmarks/support/measure.hpp"
#include "benchmarks/support/table.hpp"
#include "cairn/io/graph_file.hpp"
#include "cairn/solver/optimize.hpp"
#include "datasets/simulate.hpp"

namespace cairn::bench {
namespace {

enum Number {
  kPoses,
  kEdges,
  kRead,
  kInit,
  kSetup,
  kIterations,
  kPerIteration,
  kTotal,
  kChi2Ratio,
  kCount
};

// The child: prints the numbers above.
int solve(const std::string& path) {
  const Stopwatch watch;
  auto document = read_graph(path);
  if (!document) {
    std::fprintf(stderr, "%s\n", document.error().to_string().c_str());
    return 1;
  }
  const double read_s = watch.seconds();
  Graph& graph = document->graph;
  const SolveSummary summary = optimize(graph, {.init = InitMethod::kAuto});
  double init_s = 0.0, iterations_s = 0.0;
  for (const InitCandidate& candidate : summary.init_candidates) init_s += candidate.seconds;
  for (const IterationReport& iteration : summary.iterations) iterations_s += iteration.total_s;
  const double count = static_cast<double>(summary.iterations.size());
  std::printf("%zu %zu %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", graph.variables().size(),
              graph.factor_count(), read_s, init_s, summary.setup_s - init_s, count,
              iterations_s / count, watch.seconds(),
              summary.final_chi2 / static_cast<double>(summary.degrees_of_freedom));
  return summary.usable() ? 0 : 4;
}

// Another child: writes a city.
int simulate_city(const std::string& poses, const std::string& path) {
  auto city = simulate(
      {.world = World::kCity, .poses = static_cast<std::size_t>(std::atoll(poses.c_str()))});
  if (!city) return 1;
  GraphDocument document;
  document.graph = std::move(city->graph);
  document.has_start.assign(document.graph.variables().size(), true);
  return write_graph(document, path, GraphFormat::kG2o) ? 0 : 1;
}

std::string count_text(double count) { return std::to_string(static_cast<long long>(count)); }

std::optional<ChildReport> measure(double poses) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("cairn_city_" + count_text(poses) + ".g2o"))
          .string();
  std::optional<ChildReport> report;
  if (run_this_program({"--simulate", count_text(poses), path}))
    report = run_this_program({"--solve", path});
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
  if (report && report->numbers.size() != kCount) return std::nullopt;
  return report;
}

}  // namespace
}  // namespace cairn::bench

int main(int argc, char** argv) {
  using namespace cairn::bench;
  if (argc == 3 && std::strcmp(argv[1], "--solve") == 0) return solve(argv[2]);
  if (argc == 4 && std::strcmp(argv[1], "--simulate") == 0) return simulate_city(argv[2], argv[3]);
  std::vector<double> sizes{1e4, 1e5, 1e6};
  if (argc > 1) {
    sizes.clear();
    for (int i = 1; i < argc; ++i) sizes.push_back(std::atof(argv[i]));
  }
  std::puts("## Growth: simulated cities, `--init auto`, one thread\n");
  const Table table({"poses", "edges", "read", "initialization", "set-up", "iterations",
                     "per iteration", "total", "peak memory", "chi2 / degrees of freedom"});
  std::vector<double> poses, totals, per_iteration, memory;
  for (const double size : sizes) {
    const auto report = measure(size);
    if (!report) {
      table.row({count_text(size), "failed", "", "", "", "", "", "", "", ""});
      continue;
    }
    const std::vector<double>& n = report->numbers;
    table.row({count_text(n[kPoses]), count_text(n[kEdges]), time_text(n[kRead]),
               time_text(n[kInit]), time_text(n[kSetup]), count_text(n[kIterations]),
               time_text(n[kPerIteration]), time_text(n[kTotal]),
               megabytes_text(report->peak_bytes), number_text(n[kChi2Ratio], 4)});
    poses.push_back(n[kPoses]);
    totals.push_back(n[kTotal]);
    per_iteration.push_back(n[kPerIteration]);
    memory.push_back(report->peak_bytes);
  }
  if (poses.size() < 2) return 1;
  std::printf("\nFitted exponents over poses: total %.2f, per iteration %.2f, peak memory %.2f\n",
              fitted_exponent(poses, totals), fitted_exponent(poses, per_iteration),
              fitted_exponent(poses, memory));
}
