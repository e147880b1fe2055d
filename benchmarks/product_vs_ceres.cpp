// SPDX-License-Identifier: BSD-3-Clause
// Product against product: what a user waits for. Cairn chooses its own start (--init auto, its
// time counted); Ceres starts from the file, or from odometry where there are only edges.
#include <cmath>
#include <cstdio>

#include "benchmarks/support/cairn_run.hpp"
#include "benchmarks/support/ceres_rival.hpp"
#include "benchmarks/support/graphs.hpp"
#include "benchmarks/support/measure.hpp"
#include "benchmarks/support/table.hpp"
#include "cairn/linear/single_thread_blas.hpp"

namespace cairn::bench {
namespace {

std::string run_text(double seconds, double chi2) {
  return std::isfinite(seconds) ? time_text(seconds) : "never (" + number_text(chi2) + ")";
}

// The goal is the lower of what the two find, whatever the other makes of it.
void compare(const BenchmarkGraph& which, const Graph& graph, int rounds, const Table& table) {
  const SolveOptions options{.init = InitMethod::kAuto};
  CeresPoseGraph rival(graph);
  const double optimum = std::min(run_cairn(graph, 0.0, options).final_chi2,
                                  rival.run(CeresSettings::kTuned, 0.0).final_chi2);
  CairnRun ours;
  CeresRun tuned;
  const std::function<double()> contenders[] = {
      [&] {
        ours = run_cairn(graph, target_of(optimum), options);
        return ours.to_optimum_s.value_or(NAN);
      },
      [&] {
        tuned = rival.run(CeresSettings::kTuned, target_of(optimum));
        return tuned.to_optimum_s.value_or(NAN);
      },
  };
  const std::vector<double> seconds = interleaved_medians(rounds, contenders);
  table.row({std::string(which.name), which.planar ? "2-D" : "3-D", number_text(optimum, 6),
             std::string(to_string(ours.init)), std::to_string(ours.iterations),
             run_text(seconds[0], ours.final_chi2), std::to_string(tuned.iterations),
             run_text(seconds[1], tuned.final_chi2), ratio_text(seconds[1] / seconds[0])});
}

}  // namespace
}  // namespace cairn::bench

int main(int argc, char** argv) {
  using namespace cairn::bench;
  const Arguments arguments = parse_arguments(argc, argv);
  const cairn::SingleThreadBlas single_thread;
  std::printf(
      "## Product against product: `--init auto` against tuned Ceres from the file, median of "
      "%d\n\n",
      arguments.rounds);
  const Table table({"graph", "", "chi2", "start", "iterations", "Cairn", "Ceres iterations",
                     "Ceres tuned", "Ceres / Cairn"});
  for (const BenchmarkGraph& which : benchmark_graphs()) {
    if (!arguments.wants(which.name)) continue;
    const std::optional<cairn::Graph> graph = load(which);
    if (graph) compare(which, *graph, arguments.rounds, table);
  }
}
