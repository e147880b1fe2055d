// SPDX-License-Identifier: BSD-3-Clause
#include "benchmarks/support/cairn_run.hpp"

#include <algorithm>

#include "benchmarks/support/ceres_rival.hpp"
#include "benchmarks/support/measure.hpp"

namespace cairn::bench {

CairnRun run_cairn(const Graph& graph, double target_chi2, SolveOptions options) {
  Graph copy = graph;
  CairnRun run;
  const Stopwatch watch;
  options.on_iteration = [&](int number, const IterationReport& report) {
    if (report.chi2 > target_chi2) return true;
    run.to_optimum_s = watch.seconds();
    run.iterations = number;
    return false;
  };
  const SolveSummary summary = optimize(copy, options);
  // A start that is good enough already needs no iteration.
  if (!run.to_optimum_s && summary.final_chi2 <= target_chi2) run.to_optimum_s = watch.seconds();
  run.final_chi2 = summary.final_chi2;
  run.init = summary.init_chosen;
  run.setup_s = summary.setup_s;
  for (const IterationReport& iteration : summary.iterations) {
    run.linearize_s += iteration.linearize_s;
    run.factorize_s += iteration.factorize_s;
    run.solve_s += iteration.solve_s;
  }
  return run;
}

double find_optimum(const Graph& start) {
  CeresPoseGraph rival(start);
  return std::min(rival.run(CeresSettings::kTuned, 0.0).final_chi2,
                  run_cairn(start, 0.0).final_chi2);
}

}  // namespace cairn::bench
