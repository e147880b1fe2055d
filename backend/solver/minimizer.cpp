// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/minimizer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cairn/core/stopwatch.hpp"
#include "cairn/solver/rank.hpp"
#include "cairn/solver/step.hpp"

namespace cairn {
namespace {

// A step that promises less than this part of the cost is the last one; so is one that leaves less.
constexpr double kSmallDecrease = 1e-9;
// m, rad: below what any sensor or controller can tell.
constexpr double kSmallStep = 1e-11;
// Gauss-Newton may climb out of a bad start, but not for ever.
constexpr int kMaxIncreases = 20;
constexpr int kMaxHalvings = 3;

// One run of the loop: linearize -> propose -> retract -> judge -> accept or reject.
class Minimizer {
 public:
  Minimizer(NormalEquations& equations, LinearSolver& linear, const SolveOptions& options,
            ThreadPool& pool, Values& values, RangeCost initial, bool check_rank)
      : equations_(equations),
        linear_(linear),
        options_(options),
        pool_(pool),
        best_(values),
        strategy_(make_step_strategy(options.method)),
        cost_(initial),
        best_cost_(initial),
        check_rank_(check_rank) {
    result_.initial = initial;
  }

  MinimizerResult run() {
    current_ = best_;
    result_.reason = iterate();
    result_.final = best_cost_;
    if (result_.reason != StopReason::kNotFinite && !result_.looks_singular)
      predict_remaining_decrease();
    return std::move(result_);
  }

 private:
  StopReason iterate() {
    if (!std::isfinite(cost_.cost) || !equations_.is_finite()) return StopReason::kNotFinite;
    if (is_stationary()) return check_rank_at_start();
    for (int number = 1; number <= options_.max_iterations; ++number) {
      const Stopwatch watch;
      IterationReport report;
      report.lambda = strategy_->lambda();
      const std::optional<StopReason> stop = one_iteration(report);
      report.chi2 = best_cost_.chi2;
      report.total_s = watch.seconds();
      result_.iterations.push_back(report);
      const bool go_on = !options_.on_iteration || options_.on_iteration(number, report);
      if (stop) return *stop;
      if (!go_on) return StopReason::kInterrupted;
      if (options_.work == nullptr) continue;
      options_.work->spend(equations_.layout().iteration_work);
      if (options_.work->spent()) return StopReason::kWorkLimit;
    }
    return StopReason::kIterationLimit;
  }

  // A start that is the minimum already can have free variables all the same.
  StopReason check_rank_at_start() {
    if (!check_rank_ || equations_.pattern().size() == 0) return StopReason::kGradient;
    StepTimes times;
    result_.looks_singular = is_singular(strategy_->propose(equations_, linear_, times));
    return StopReason::kGradient;
  }

  // Nothing where the loop shall go on.
  std::optional<StopReason> one_iteration(IterationReport& report) {
    if (!linearized_at_current_) relinearize(report);
    StepTimes times;
    const Step step = strategy_->propose(equations_, linear_, times);
    report.factorize_s = times.factorize_s;
    report.solve_s = times.solve_s;
    if (check_rank_ && is_singular(step)) {
      result_.looks_singular = true;
      return StopReason::kLambdaExhausted;
    }
    check_rank_ = false;
    if (!step.valid) return reject();
    const bool last = step.newton && step.predicted_decrease <= kSmallDecrease * cost_.cost;
    const bool small_step = step.dx.size() == 0 || step.dx.cwiseAbs().maxCoeff() <= kSmallStep;
    const bool leaves_little = would_leave_little(step);
    equations_.retract(current_, step.dx, trial_);
    RangeCost trial_cost = evaluate_trial(last || small_step || leaves_little, report);
    double predicted_decrease = step.predicted_decrease;
    if (!(trial_cost.cost <= cost_.cost) && !last && !strategy_->accepts_increase()) {
      predicted_decrease = backtrack(step, trial_cost, report);
    }
    const double gain = cost_.cost - trial_cost.cost;
    const bool better = gain >= 0.0;
    if (better || (strategy_->accepts_increase() && std::isfinite(trial_cost.cost) &&
                   increases_ < kMaxIncreases)) {
      increases_ = better ? 0 : increases_ + 1;
      report.accepted = true;
      accept(trial_cost, gain / predicted_decrease);
      previous_decrease_ = step.predicted_decrease;
    }
    const bool model_held =
        std::abs(gain - step.predicted_decrease) <= 0.1 * step.predicted_decrease;
    if (last || (report.accepted && leaves_little && model_held)) return StopReason::kSmallDecrease;
    if (small_step && step.newton) return StopReason::kSmallStep;
    if (report.accepted)
      return is_stationary() ? std::optional(StopReason::kGradient) : std::nullopt;
    // No use in more damping. Whether rounding is in the way or the model is wrong is told at the
    // end.
    if (step.predicted_decrease <= kSmallDecrease * cost_.cost) return StopReason::kLambdaExhausted;
    return reject();
  }

  // Near the minimum each Newton step leaves a small, steady part of what it promised. Where that
  // part is small and the model holds, what remains is known without another factorization.
  [[nodiscard]] bool would_leave_little(const Step& step) const {
    if (!step.newton || !(previous_decrease_ > 0.0)) return false;
    const double left = step.predicted_decrease / previous_decrease_;  // of the decrease
    return left < 0.1 && left * step.predicted_decrease <= kSmallDecrease * cost_.cost;
  }

  // Shortens a step that went too far: trial and its cost become those of the first length that
  // gains a tenth of what the model promises, or stay. Damping would bend the step away from just
  // the directions that are measured least, in which a badly started map has to move most; trying a
  // length needs no factorization.
  double backtrack(const Step& step, RangeCost& trial_cost, IterationReport& report) {
    double length = 1.0;
    for (int halving = 0; halving < kMaxHalvings; ++halving) {
      length *= 0.5;
      const double predicted = length * (2.0 - length) * step.predicted_decrease;
      equations_.retract(current_, length * step.dx, trial_);
      const RangeCost cost = evaluate_trial(true, report);
      if (!(cost_.cost - cost.cost >= 0.1 * predicted)) continue;
      trial_cost = cost;
      return predicted;
    }
    return step.predicted_decrease;
  }

  // Linearizes at the trial, speculating that it will be accepted; what is likely to be the last
  // step needs its cost only.
  RangeCost evaluate_trial(bool cost_only, IterationReport& report) {
    const Stopwatch watch;
    const RangeCost cost = cost_only ? equations_.evaluate_cost(context(trial_), pool_)
                                     : equations_.linearize(context(trial_), pool_);
    linearized_at_current_ = false;
    linearized_at_trial_ = !cost_only;
    report.linearize_s += watch.seconds();
    return cost;
  }

  void accept(const RangeCost& trial_cost, double gain_ratio) {
    std::swap(current_, trial_);
    cost_ = trial_cost;
    linearized_at_current_ = linearized_at_trial_;
    strategy_->accepted(gain_ratio);
    if (cost_.cost <= best_cost_.cost) {
      best_ = current_;
      best_cost_ = cost_;
    }
  }

  std::optional<StopReason> reject() {
    strategy_->rejected();
    if (strategy_->exhausted()) return StopReason::kLambdaExhausted;
    return std::nullopt;
  }

  void relinearize(IterationReport& report) {
    const Stopwatch watch;
    equations_.linearize(context(current_), pool_);
    linearized_at_current_ = true;
    report.linearize_s += watch.seconds();
  }

  // g^T diag(H)^-1 g bounds what single variables could gain; at rounding level nothing is left to
  // do.
  [[nodiscard]] bool is_stationary() const {
    if (!linearized_at_current_) return false;
    const Eigen::VectorXd& g = equations_.gradient();
    const Eigen::VectorXd& D = equations_.diagonal();
    double decrease = 0.0;
    for (Eigen::Index i = 0; i < g.size(); ++i) {
      if (D[i] > 0.0) decrease += g[i] * g[i] / D[i];
    }
    return decrease <= 1e-24 * (1.0 + cost_.cost);
  }

  [[nodiscard]] bool is_singular(const Step& step) const {
    if (!step.valid) return true;
    const std::optional<SupernodalFactor> factor = linear_.factor();
    return factor && looks_singular(*factor, equations_.diagonal());
  }

  // Needed only where the loop did not end by itself: is the result usable nevertheless? Damping
  // makes any step promise little; an undamped one tells whether anything was left to gain.
  void predict_remaining_decrease() {
    const bool converged = result_.reason == StopReason::kSmallDecrease ||
                           result_.reason == StopReason::kSmallStep ||
                           result_.reason == StopReason::kGradient;
    if (converged) return;
    equations_.linearize(context(best_), pool_);
    StepTimes times;
    const Step step = make_step_strategy(Method::kGaussNewton)->propose(equations_, linear_, times);
    result_.predicted_chi2_decrease =
        step.valid ? 2.0 * step.predicted_decrease : std::numeric_limits<double>::infinity();
    if (result_.reason == StopReason::kLambdaExhausted && step.valid &&
        step.predicted_decrease <= kSmallDecrease * std::max(best_cost_.cost, 1.0))
      result_.reason = StopReason::kSmallDecrease;
  }

  [[nodiscard]] EvaluationContext context(const Values& values) const {
    return {values, options_.chart, options_.loss, options_.loss_on_loops_only};
  }

  NormalEquations& equations_;
  LinearSolver& linear_;
  const SolveOptions& options_;
  ThreadPool& pool_;
  Values& best_;
  Values current_, trial_;
  std::unique_ptr<StepStrategy> strategy_;
  RangeCost cost_, best_cost_;
  bool linearized_at_current_ = true;
  bool linearized_at_trial_ = false;
  int increases_ = 0;
  double previous_decrease_ = 0.0;  // predicted by the last accepted step
  bool check_rank_;
  MinimizerResult result_;
};

}  // namespace

MinimizerResult minimize(NormalEquations& equations, LinearSolver& linear,
                         const SolveOptions& options, ThreadPool& pool, Values& values,
                         RangeCost initial, bool check_rank) {
  return Minimizer(equations, linear, options, pool, values, initial, check_rank).run();
}

}  // namespace cairn
