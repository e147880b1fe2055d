// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/optimize.hpp"

#include "cairn/core/stopwatch.hpp"
#include "cairn/linear/linear_solver.hpp"
#include "cairn/solver/ceres_backend.hpp"
#include "cairn/solver/initialize.hpp"
#include "cairn/solver/minimizer.hpp"
#include "cairn/solver/problem.hpp"

namespace cairn {
namespace {

std::unique_ptr<LinearSolver> make_linear_solver(LinearBackend backend) {
  switch (backend) {
    case LinearBackend::kEigen:
      return make_eigen_solver();
    case LinearBackend::kPcg:
      return make_pcg_solver();
    case LinearBackend::kCholmod:
    case LinearBackend::kCeres:
      break;
  }
  return make_cholmod_solver();
}

std::int64_t degrees_of_freedom(const Problem& problem) {
  std::int64_t dof = 0;
  for (const auto& batch : problem.graph->batches()) {
    dof += static_cast<std::int64_t>(batch->size()) * batch->residual_dimension();
  }
  for (std::size_t slot = 0; slot < problem.held.size(); ++slot) {
    if (!problem.held[slot]) dof -= tangent_dimension(problem.graph->variables()[slot].type);
  }
  return dof;
}

SolveStatus status_of(const MinimizerResult& result) {
  switch (result.reason) {
    case StopReason::kSmallStep:
    case StopReason::kSmallDecrease:
    case StopReason::kGradient:
      return SolveStatus::kConverged;
    case StopReason::kIterationLimit:
      return SolveStatus::kIterationLimit;
    case StopReason::kLambdaExhausted:
    case StopReason::kNotFinite:
    case StopReason::kInterrupted:
      break;
  }
  return SolveStatus::kFailed;
}

void report(const MinimizerResult& result, SolveSummary& summary) {
  summary.stop_reason = result.reason;
  summary.status = status_of(result);
  summary.initial_chi2 = result.initial.chi2;
  summary.final_chi2 = result.final.chi2;
  summary.final_cost = result.final.cost;
  summary.iterations = result.iterations;
  summary.usable_result = summary.status == SolveStatus::kConverged ||
                          (result.reason != StopReason::kNotFinite &&
                           result.predicted_chi2_decrease <= 1e-6 * std::max(result.final.chi2, 1.0));
}

}  // namespace

SolveSummary optimize(Graph& graph, const SolveOptions& options) {
  const Stopwatch watch;
  SolveSummary summary;
  summary.threads = options.threads;
  summary.linear = options.linear;
  const Problem problem(graph);
  summary.components = problem.components;
  summary.gauge = problem.gauge;
  summary.degrees_of_freedom = degrees_of_freedom(problem);
  initialize(problem, options, graph.values(), summary);
#ifdef CAIRN_WITH_CERES
  if (options.linear == LinearBackend::kCeres) {
    const std::vector<char> held(problem.held.begin(), problem.held.end());
    solve_with_ceres(graph, held, options, summary);
    summary.optimize_s = watch.seconds();
    return summary;
  }
#endif
  ThreadPool pool(options.threads);
  const UnknownLayout layout(problem);
  NormalEquations equations(problem, layout);
  const std::unique_ptr<LinearSolver> linear = make_linear_solver(options.linear);
  linear->analyze(equations.pattern(), layout.elimination);
  const EvaluationContext context{graph.values(), options.chart, options.loss, options.loss_on_loops_only};
  const RangeCost initial = equations.linearize(context, pool);
  summary.setup_s = watch.seconds();
  report(minimize(equations, *linear, options, pool, graph.values(), initial), summary);
  summary.ordering = layout.elimination.method;
  summary.factor_nonzeros = linear->factor_nonzeros();
  summary.optimize_s = watch.seconds();
  return summary;
}

}  // namespace cairn
