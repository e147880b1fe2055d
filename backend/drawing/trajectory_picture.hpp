// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "cairn/core/result.hpp"
#include "cairn/drawing/picture.hpp"

namespace cairn {

/// An estimated trajectory against its reference. Positions are in one frame (already aligned), m;
/// planar trajectories have z = 0.
struct TrajectoryErrors {
  std::vector<Eigen::Vector3d> reference;  ///< all positions in order, at least one
  std::vector<Eigen::Vector3d> estimate;   ///< all positions in order, at least one

  /// The errors to show: `error[i]` belongs to estimate[`index[i]`] and is drawn at `path_m[i]`,
  /// the length of the reference path up to there. Indices ascend.
  std::vector<std::size_t> index;
  std::vector<double> path_m;
  std::vector<double> error;
  std::string error_label = "position error [m]";
  /// One line of numbers under the title ("rmse 1.303 m, ...").
  std::string summary{};
};

/// Draws the estimate coloured by its error beside the reference, and the error over the path.
/// Refuses empty and non-finite input and vectors of unequal length with kBadInput.
Result<void> draw_trajectory_errors(const TrajectoryErrors& errors, const std::string& path,
                                    const PictureOptions& options = {});

}  // namespace cairn
