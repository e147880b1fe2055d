// SPDX-License-Identifier: BSD-3-Clause
// How much memory does a solve need, against Ceres? Each side reads the start where both begin and
// solves in a process of its own; a third process reads only.
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "benchmarks/support/ceres_rival.hpp"
#include "benchmarks/support/child_process.hpp"
#include "benchmarks/support/graphs.hpp"
#include "benchmarks/support/table.hpp"
#include "cairn/io/graph_file.hpp"
#include "cairn/linear/single_thread_blas.hpp"
#include "cairn/solver/optimize.hpp"

namespace cairn::bench {
namespace {

enum class Side { kReading, kCairn, kCeres };
constexpr const char* kSides[] = {"--reading", "--cairn", "--ceres"};

// The child: solves to convergence. Ceres' cost functions are made from our graph, which is then
// given back.
int solve(const std::string& side, const std::string& path) {
  std::optional<Graph> graph;
  {
    Result<GraphDocument> document = read_graph(path);
    if (!document) return 1;
    graph = std::move(document->graph);
  }
  if (side == kSides[static_cast<int>(Side::kCairn)]) return optimize(*graph).usable() ? 0 : 1;
  if (side == kSides[static_cast<int>(Side::kCeres)]) {
    CeresPoseGraph rival(*graph);
    rival.build();
    graph.reset();
    return rival.solve(CeresSettings::kTuned) ? 0 : 1;
  }
  return 0;
}

// A file with the common start; false where there is no graph.
bool write_start(const BenchmarkGraph& which, const std::string& path) {
  const std::optional<Graph> graph = load(which);
  if (!graph) return false;
  GraphDocument start;
  start.graph = common_start(which, *graph);
  return write_graph(start, path, GraphFormat::kG2o).ok();
}

std::string peak_text(const std::optional<ChildReport>& report) {
  return report ? megabytes_text(report->peak_bytes) : "failed";
}

}  // namespace
}  // namespace cairn::bench

int main(int argc, char** argv) {
  using namespace cairn::bench;
  if (argc == 3 && std::strncmp(argv[1], "--", 2) == 0 && std::strcmp(argv[1], "--rounds") != 0) {
    const cairn::SingleThreadBlas single_thread;
    return solve(argv[1], argv[2]);
  }
  const Arguments arguments = parse_arguments(argc, argv);
  std::puts("## Peak resident memory, separate processes\n");
  const std::string path =
      (std::filesystem::temp_directory_path() / "cairn_peak_memory.g2o").string();
  const Table table({"graph", "reading only", "Cairn", "Ceres tuned", "Ceres / Cairn"});
  for (const BenchmarkGraph& which : benchmark_graphs()) {
    if (!arguments.wants(which.name) || !write_start(which, path)) continue;
    const auto reading = run_this_program({kSides[0], path});
    const auto ours = run_this_program({kSides[1], path});
    const auto theirs = run_this_program({kSides[2], path});
    table.row({std::string(which.name) + (which.chordal_start ? " (chordal start)" : ""),
               peak_text(reading), peak_text(ours), peak_text(theirs),
               ours && theirs ? ratio_text(theirs->peak_bytes / ours->peak_bytes) : "-"});
  }
  std::filesystem::remove(path);
}
