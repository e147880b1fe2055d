// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "cairn/graph/graph.hpp"
#include "cairn/solver/loop_cycles.hpp"
#include "cairn/solver/marginals.hpp"

namespace cairn {

/// How loop closures fit the values of a graph, in units of what they state of themselves.
/// Factors by their places in Graph::factors().
template <class Pose>
class LoopFit {
 public:
  static constexpr int kDimension = UncertainPose<Pose>::kDimension;
  using Vector = Eigen::Matrix<double, kDimension, 1>;
  using Matrix = Eigen::Matrix<double, kDimension, kDimension>;

  /// Keeps a reference.
  LoopFit(const Graph& graph, ErrorChart chart) : graph_(graph), chart_(chart) {}

  [[nodiscard]] double chi2(std::size_t factor) const;
  /// Against where the solution would be without it; exact for small errors. `with`: of the
  /// solution that has it. To take a measurement out takes its information out: the covariance of
  /// the difference is that of the measurement minus that of the solution.
  [[nodiscard]] double chi2_without(std::size_t factor, const Marginals& with) const;
  /// As the increase of chi2 that it would bring. `without`: of the solution that has it not.
  [[nodiscard]] double chi2_of_newcomer(std::size_t factor, const Marginals& without) const;

  struct Whitened {
    VariableSlot a, b;  ///< as the factor has them
    Vector error;
    Matrix J;  ///< by T_a_b: as by the second pose
  };
  [[nodiscard]] Whitened whitened(std::size_t factor) const;

 private:
  const Graph& graph_;
  ErrorChart chart_;
};

}  // namespace cairn
