// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/optimize.hpp"

#include <algorithm>

#include "cairn/core/stopwatch.hpp"
#include "cairn/linear/linear_solver.hpp"
#include "cairn/solver/ceres_backend.hpp"
#include "cairn/solver/initialize.hpp"
#include "cairn/solver/minimizer.hpp"
#include "cairn/solver/problem.hpp"
#include "cairn/solver/rank.hpp"

namespace cairn {
namespace {

std::unique_ptr<LinearSolver> make_linear_solver(LinearBackend backend, Kernel kernel) {
  switch (backend) {
    case LinearBackend::kEigen:
      return make_eigen_solver();
    case LinearBackend::kPcg:
      return make_pcg_solver();
    case LinearBackend::kCholmod:
      return make_cholmod_solver();
    case LinearBackend::kMultifrontal:
    case LinearBackend::kCeres:
      break;
  }
  return make_multifrontal_solver(kernel);
}

// Back-ends that do not show their factor cannot see that they fail.
bool shows_pivots(LinearBackend backend) {
  return backend == LinearBackend::kMultifrontal || backend == LinearBackend::kCholmod;
}

// Waking a thread costs as much as a hundred microseconds of linearization: small graphs stay on
// one.
int threads_that_pay(const Graph& graph, int requested) {
  constexpr double kMultiplicationsPerThread = 250e3;
  double multiplications = 0.0;
  for (const auto& batch : graph.batches()) {
    const double d = batch->residual_dimension();
    multiplications += static_cast<double>(batch->size()) * d * d * d;
  }
  return std::clamp(static_cast<int>(multiplications / kMultiplicationsPerThread) + 1, 1,
                    std::max(requested, 1));
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
    case StopReason::kWorkLimit:
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
  summary.usable_result =
      summary.status == SolveStatus::kConverged ||
      (result.reason != StopReason::kNotFinite &&
       result.predicted_chi2_decrease <= 1e-6 * std::max(result.final.chi2, 1.0));
}

// Optimizes what can be determined: where the matrix is singular, the free variables are set aside
// and the rest is tried again.
class Optimization {
 public:
  Optimization(Graph& graph, const SolveOptions& options)
      : graph_(graph),
        options_(options),
        problem_(graph),
        pool_(threads_that_pay(graph, options.threads)) {}

  SolveSummary run() {
    summary_.threads = pool_.threads();
    summary_.linear =
        is_available(options_.linear) ? options_.linear : LinearBackend::kMultifrontal;
    summary_.components = problem_.components;
    summary_.gauge = problem_.gauge;
    summary_.degrees_of_freedom = degrees_of_freedom(problem_);
    layout_.emplace(problem_, options_.eliminations);
    initialize(problem_, layout_->elimination, options_, graph_.values(), summary_);
    if (options_.work != nullptr)
      options_.work->spend(static_cast<double>(summary_.init_candidates.size()) *
                           layout_->iteration_work);
    summary_.setup_s = watch_.seconds();
#ifdef CAIRN_WITH_CERES
    if (options_.linear == LinearBackend::kCeres) {
      run_ceres();
      return finish();
    }
#endif
    bool check_rank = shows_pivots(options_.linear) || set_aside_free_variables();
    while (!solve(check_rank)) check_rank = set_aside_free_variables();
    return finish();
  }

 private:
  // False when the matrix looks singular and nothing was moved.
  bool solve(bool check_rank) {
    const Stopwatch setup_watch;
    NormalEquations equations(problem_, *layout_);
    const std::unique_ptr<LinearSolver> linear =
        make_linear_solver(options_.linear, options_.kernel);
    linear->analyze(equations.pattern(), layout_->elimination);
    const RangeCost initial = equations.linearize(context(), pool_);
    summary_.setup_s += setup_watch.seconds();
    const MinimizerResult result =
        minimize(equations, *linear, options_, pool_, graph_.values(), initial, check_rank);
    if (result.looks_singular) return false;
    report(result, summary_);
    summary_.ordering = layout_->elimination.method;
    summary_.factor_nonzeros = linear->factor_nonzeros();
    return true;
  }

  // False when every direction is determined (the matrix is only badly conditioned): do not ask
  // again.
  bool set_aside_free_variables() {
    bool any = false;
    while (true) {
      NormalEquations equations(problem_, *layout_);
      equations.linearize(context(), pool_);
      if (!equations.is_finite()) return any;  // for the loop to report
      const RankReport free = find_free_directions(equations, options_.kernel);
      if (free.full_rank()) return any;
      any = true;
      std::vector<bool> dropped(problem_.held.size(), false);
      for (const auto& [slot, directions] : free.undetermined) {
        dropped[slot] = true;
        name_free_variable(slot, directions);
      }
      problem_.drop(dropped);
      layout_.emplace(problem_, options_.eliminations);
      for (const auto& [slot, directions] : free.anchors) {
        problem_.anchors.push_back({slot, directions});
        name_free_variable(slot, directions);
      }
    }
  }

  void name_free_variable(int slot, const Eigen::MatrixXd& directions) {
    summary_.under_constrained.push_back({graph_.variables()[slot].id, directions});
  }

#ifdef CAIRN_WITH_CERES
  void run_ceres() {
    set_aside_free_variables();
    solve_with_ceres(problem_, options_, graph_.values(), summary_);
  }
#endif

  SolveSummary finish() {
    if (!summary_.under_constrained.empty() && summary_.status == SolveStatus::kConverged) {
      summary_.status = SolveStatus::kPartiallyConstrained;
    }
    summary_.optimize_s = watch_.seconds();
    return std::move(summary_);
  }

  [[nodiscard]] EvaluationContext context() const {
    return {graph_.values(), options_.chart, options_.loss, options_.loss_on_loops_only};
  }

  Stopwatch watch_;
  Graph& graph_;
  const SolveOptions& options_;
  Problem problem_;
  std::optional<UnknownLayout> layout_;
  ThreadPool pool_;
  SolveSummary summary_;
};

}  // namespace

bool is_available(LinearBackend backend) {
#ifdef CAIRN_WITH_CERES
  static_cast<void>(backend);
  return true;
#else
  return backend != LinearBackend::kCeres;
#endif
}

SolveSummary optimize(Graph& graph, const SolveOptions& options) {
  return Optimization(graph, options).run();
}

}  // namespace cairn
