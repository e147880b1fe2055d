// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "cairn/linear/linear_solver.hpp"
#include "cairn/solver/normal_equations.hpp"
#include "cairn/solver/solve_summary.hpp"

namespace cairn {

/// Unknowns that the measurements leave free, by the null space of H at the linearization point of
/// `equations`.
struct RankReport {
  struct FreeVariable {
    int slot;
    Eigen::MatrixXd directions;  ///< orthonormal columns in its tangent space
  };
  /// Free by themselves: they keep their value and their factors say nothing about the others.
  std::vector<FreeVariable> undetermined;
  /// One pose for each motion that leaves a whole component's cost unchanged: held in these
  /// directions only.
  std::vector<FreeVariable> anchors;

  [[nodiscard]] bool full_rank() const { return undetermined.empty() && anchors.empty(); }
};

/// Costs a few factorizations and one solve per free direction. `equations` stay linearized,
/// undamped.
RankReport find_free_directions(NormalEquations& equations, Kernel kernel = Kernel::kFastest);

/// True when the smallest pivot of the factor of H is at rounding level relative to diag(H).
bool looks_singular(const SupernodalFactor& factor, const Eigen::VectorXd& diagonal);

}  // namespace cairn
