// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cairn/core/stopwatch.hpp"

namespace cairn {
namespace {

// dx = -(H + lambda diag(H))^-1 g. The model's decrease is -g dx - dx H dx / 2.
Step damped_step(NormalEquations& equations, LinearSolver& linear, double lambda,
                 StepTimes& times) {
  Step step;
  const Stopwatch factorize_watch;
  equations.set_damping(lambda);
  step.valid = linear.factorize(equations.values());
  times.factorize_s += factorize_watch.seconds();
  if (!step.valid) return step;
  const Stopwatch solve_watch;
  const Eigen::VectorXd& g = equations.gradient();
  step.dx.resize(g.size());
  linear.solve(g.data(), step.dx.data());
  step.dx = -step.dx;
  times.solve_s += solve_watch.seconds();
  const double dx_D_dx = step.dx.cwiseAbs2().dot(equations.diagonal());
  step.predicted_decrease = 0.5 * (lambda * dx_D_dx - g.dot(step.dx));
  step.valid = std::isfinite(step.predicted_decrease);
  step.newton = lambda <= 1e-6;
  return step;
}

// Marquardt 1963, without damping until a step fails: well-posed problems see Gauss-Newton steps.
class LevenbergMarquardt final : public StepStrategy {
 public:
  Step propose(NormalEquations& equations, LinearSolver& linear, StepTimes& times) override {
    return damped_step(equations, linear, lambda_, times);
  }
  void accepted(double gain_ratio) override {
    growth_ = 4.0;
    if (gain_ratio > 0.75)
      lambda_ = lambda_ > kSmallest ? lambda_ * 0.05 : 0.0;
    else if (gain_ratio < 0.25)
      lambda_ = std::max(lambda_ * 2.0, kFirstRaise);
  }
  void rejected() override {
    lambda_ = std::max(lambda_ * growth_, kFirstRaise);
    growth_ *= 2.0;
  }
  [[nodiscard]] bool exhausted() const override { return lambda_ > 1e12; }
  [[nodiscard]] double lambda() const override { return lambda_; }

 private:
  static constexpr double kSmallest = 1e-10;
  static constexpr double kFirstRaise = 1e-5;

  double lambda_ = 0.0;
  double growth_ = 4.0;
};

class GaussNewton final : public StepStrategy {
 public:
  Step propose(NormalEquations& equations, LinearSolver& linear, StepTimes& times) override {
    Step step = damped_step(equations, linear, 0.0, times);
    failed_ = !step.valid;
    return step;
  }
  void accepted(double /*gain_ratio*/) override {}
  void rejected() override {}
  [[nodiscard]] bool exhausted() const override { return failed_; }
  [[nodiscard]] double lambda() const override { return 0.0; }
  [[nodiscard]] bool accepts_increase() const override { return true; }

 private:
  bool failed_ = false;
};

// Powell's dogleg in the metric of diag(H) (Nocedal & Wright 2006, section 4.1): along steepest
// descent to the Cauchy point, then towards the Gauss-Newton point, cut at the trust radius.
class Dogleg final : public StepStrategy {
 public:
  Step propose(NormalEquations& equations, LinearSolver& linear, StepTimes& times) override {
    if (!have_newton_ && !prepare(equations, linear, times)) return {};
    Step step;
    step.valid = true;
    const Eigen::VectorXd& D = equations.diagonal();
    const auto norm = [&](const Eigen::VectorXd& v) { return std::sqrt(v.cwiseAbs2().dot(D)); };
    const double newton_norm = norm(newton_.dx), cauchy_norm = norm(cauchy_);
    if (radius_ < 0.0) radius_ = std::numeric_limits<double>::infinity();
    if (newton_norm <= radius_) {
      step = newton_;
      step_norm_ = newton_norm;
      return step;
    }
    if (cauchy_norm >= radius_) {
      step.dx = radius_ / cauchy_norm * cauchy_;
    } else {
      const Eigen::VectorXd leg = newton_.dx - cauchy_;
      const double a = leg.cwiseAbs2().dot(D), b = cauchy_.cwiseProduct(D).dot(leg);
      const double c = cauchy_norm * cauchy_norm - radius_ * radius_;
      step.dx = cauchy_ + (-b + std::sqrt(b * b - a * c)) / a * leg;
    }
    step_norm_ = radius_;
    step.predicted_decrease = model_decrease(equations, step.dx);
    return step;
  }
  void accepted(double gain_ratio) override {
    have_newton_ = false;
    if (gain_ratio > 0.75)
      radius_ = std::max(radius_, 3.0 * step_norm_);
    else if (gain_ratio < 0.25)
      radius_ = 0.5 * step_norm_;
  }
  void rejected() override { radius_ = 0.5 * step_norm_; }
  [[nodiscard]] bool exhausted() const override {
    return (failed_ && !have_newton_) || radius_ < 1e-12;
  }
  [[nodiscard]] double lambda() const override { return radius_; }

 private:
  bool prepare(NormalEquations& equations, LinearSolver& linear, StepTimes& times) {
    failed_ = true;
    for (double lambda = 0.0; lambda < 1.0; lambda = std::max(1e-10, lambda * 100.0)) {
      newton_ = damped_step(equations, linear, lambda, times);
      if (newton_.valid) break;
    }
    if (!newton_.valid) return false;
    failed_ = false;
    have_newton_ = true;
    const Eigen::VectorXd& g = equations.gradient();
    const Eigen::VectorXd direction = -g.cwiseQuotient(equations.diagonal());
    cauchy_ = -g.dot(direction) / curvature(equations, direction) * direction;
    return true;
  }
  static double curvature(NormalEquations& equations, const Eigen::VectorXd& v) {
    equations.set_damping(0.0);
    Eigen::VectorXd Hv(v.size());
    multiply(equations.pattern(), equations.values(), v.data(), Hv.data());
    return v.dot(Hv);
  }
  static double model_decrease(NormalEquations& equations, const Eigen::VectorXd& dx) {
    return -equations.gradient().dot(dx) - 0.5 * curvature(equations, dx);
  }

  Step newton_;
  Eigen::VectorXd cauchy_;
  double radius_ = -1.0;
  double step_norm_ = 0.0;
  bool have_newton_ = false;
  bool failed_ = false;
};

}  // namespace

std::unique_ptr<StepStrategy> make_step_strategy(Method method) {
  switch (method) {
    case Method::kGaussNewton:
      return std::make_unique<GaussNewton>();
    case Method::kDogleg:
      return std::make_unique<Dogleg>();
    case Method::kLevenbergMarquardt:
      break;
  }
  return std::make_unique<LevenbergMarquardt>();
}

}  // namespace cairn
