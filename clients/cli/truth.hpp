// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "cairn/core/result.hpp"
#include "cairn/graph/graph.hpp"

namespace cairn::cli {

/// How far estimated poses are from the true ones with the same id, after the best rigid alignment.
struct TruthComparison {
  double ate_rmse_m = 0.0;  ///< absolute trajectory error: rmse of the positions
  std::size_t poses = 0;    ///< compared
  Eigen::Isometry3d T_map_truth = Eigen::Isometry3d::Identity();
};

/// Compares the poses of `graph` at `values` with those of `truth`. Refused when no pose has the
/// same id.
Result<TruthComparison> compare_with_truth(const Graph& graph, const Values& values,
                                           const Graph& truth);

}  // namespace cairn::cli
