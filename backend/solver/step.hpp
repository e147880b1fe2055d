// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>

#include "cairn/linear/linear_solver.hpp"
#include "cairn/solver/normal_equations.hpp"
#include "cairn/solver/solve_options.hpp"

namespace cairn {

/// A trial step and what the quadratic model says of it.
struct Step {
  Eigen::VectorXd dx;               ///< in elimination order
  double predicted_decrease = 0.0;  ///< of the cost (half of chi2)
  bool valid = false;               ///< false: the matrix could not be factorized
  bool newton = false;  ///< true: practically the undamped step, which leads to the model's minimum
};

struct StepTimes {
  double factorize_s = 0.0, solve_s = 0.0;
};

/// How a method proposes steps and learns from what became of them. The equations must be
/// linearized at the current iterate when propose() is called.
class StepStrategy {
 public:
  virtual ~StepStrategy() = default;
  virtual Step propose(NormalEquations& equations, LinearSolver& linear, StepTimes& times) = 0;
  /// `gain_ratio`: actual over predicted decrease; negative or not finite when the step was
  /// rejected.
  virtual void accepted(double gain_ratio) = 0;
  virtual void rejected() = 0;
  /// True when no further rejection can lead to an acceptable step.
  [[nodiscard]] virtual bool exhausted() const = 0;
  /// Damping, or the trust radius.
  [[nodiscard]] virtual double lambda() const = 0;
  /// True when a step that increases the cost is taken all the same.
  [[nodiscard]] virtual bool accepts_increase() const { return false; }
};

std::unique_ptr<StepStrategy> make_step_strategy(Method method);

}  // namespace cairn
