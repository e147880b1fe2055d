// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "cairn/core/result.hpp"
#include "cairn/graph/graph.hpp"
#include "cairn/solver/solve_options.hpp"

namespace cairn {

/// Covariances of the estimate at the current values of a graph (m, rad; tangent space of each
/// variable, in its own frame as T * Exp(d)), relative to the gauge.
class Marginals {
 public:
  /// Linearizes, factorizes, and computes the selected inverse (all blocks where the factor is
  /// non-zero).
  static Result<Marginals> compute(const Graph& graph, const SolveOptions& options = {});

  Marginals(Marginals&&) noexcept;
  Marginals& operator=(Marginals&&) noexcept;
  ~Marginals();

  /// Covariance of one variable; zero for fixed ones, NaN for under-constrained ones.
  [[nodiscard]] Eigen::MatrixXd covariance(VariableSlot variable) const;
  /// Joint covariance of two variables, a first; any pair (blocks outside the factor's pattern cost
  /// one solve).
  [[nodiscard]] Eigen::MatrixXd joint_covariance(VariableSlot a, VariableSlot b) const;
  /// Covariance of T_a_b = T_map_a^-1 * T_map_b in the tangent space at T_a_b; both must be poses
  /// of one type.
  [[nodiscard]] Eigen::MatrixXd relative_covariance(VariableSlot a, VariableSlot b) const;
  /// The same of several pairs together, one d x d block for each two of them; costs d solves a
  /// pair.
  [[nodiscard]] Eigen::MatrixXd relative_covariance(
      std::span<const std::pair<VariableSlot, VariableSlot>> pairs) const;
  /// Of the sum over pairs of weight^T times the change of T_a_b; weights are d x n. Costs n
  /// solves.
  [[nodiscard]] Eigen::MatrixXd covariance_of_sum(
      std::span<const std::pair<VariableSlot, VariableSlot>> pairs,
      std::span<const Eigen::MatrixXd> weights) const;

 private:
  struct State;
  explicit Marginals(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace cairn
