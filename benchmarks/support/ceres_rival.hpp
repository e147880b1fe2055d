// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/ceres.h>

#include <optional>
#include <vector>

#include "cairn/graph/graph.hpp"

namespace cairn::bench {

/// How the rival is set.
enum class CeresSettings {
  kTuned,    ///< near Gauss-Newton from the first step: trust region 1e12
  kDefaults  ///< what a new user gets, but for SPARSE_NORMAL_CHOLESKY on SuiteSparse, which is
             ///< Ceres' default here
};

/// A run of Ceres on a pose graph.
struct CeresRun {
  std::optional<double>
      to_optimum_s;      ///< wall time to the first iterate within the target, set-up included
  double build_s = 0.0;  ///< of it: making the Problem
  int iterations = 0;    ///< to that iterate
  double final_chi2 = 0.0;
};

/// Ceres as a user who knows it well would write it for pose graphs: one hand-written cost function
/// of fixed size per edge, analytic Jacobians, information folded in once, contiguous parameters,
/// no safety checks, one thread. The residuals are ours (g2o's chart), so chi2 is the same number.
/// Poses in the plane are (x, y, theta) without a manifold; poses in space are 7 numbers whose
/// manifold passes the 6 tangent columns through.
class CeresPoseGraph {
 public:
  /// Only graphs of between factors of one kind of pose. `graph` must outlive this object and keep
  /// its factors; the pose with the smallest id is held unless another is fixed.
  explicit CeresPoseGraph(const Graph& graph);
  ~CeresPoseGraph();

  /// Runs from the graph's values until chi2 <= target, or until Ceres stops.
  CeresRun run(CeresSettings settings, double target_chi2, int max_iterations = 200);

  /// Makes the Problem at the graph's values. run() does this too.
  void build();
  /// Solves what build() made until Ceres stops. The graph is not needed any more.
  bool solve(CeresSettings settings);

  /// The last estimates, as a graph.
  [[nodiscard]] Graph solved() const;
  /// The problem at its current values, for ceres::Covariance.
  [[nodiscard]] ceres::Problem& problem() { return *problem_; }
  [[nodiscard]] const double* pose(std::size_t index) const { return &numbers_[index * stride_]; }
  [[nodiscard]] std::size_t poses() const { return numbers_.size() / stride_; }
  [[nodiscard]] int tangent_dimension() const { return stride_ == 3 ? 3 : 6; }

 private:
  void reset();

  const Graph& graph_;
  std::size_t stride_;
  std::vector<double> numbers_;
  std::vector<std::unique_ptr<ceres::CostFunction>> costs_;
  std::unique_ptr<ceres::Manifold> manifold_;
  std::unique_ptr<ceres::Problem> problem_;
};

/// Slot of the pose that fixes the gauge of a connected graph: a fixed one, or the smallest id.
VariableSlot gauge_slot(const Graph& graph);

}  // namespace cairn::bench
