// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "frontends/matching/point_map.hpp"

namespace cairn {

struct PointToLineOptions {
  double first_reach_m = 0.5,
         last_reach_m = 0.12;  ///< of correspondences: shrinks from step to step
  int iterations = 20;
  double sigma_m = 0.02;  ///< of a distance, for the robust weight
  /// Information of the start (m, rad), in the frame of the scan: what holds where no surface does.
  Eigen::Matrix3d start_information = Eigen::Matrix3d::Zero();
};

struct PointToLineMatch {
  Se2 T_map_scan;
  /// Measured, of surfaces alone; d in T Exp(d) (m, rad). Zero in free directions.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  int free = 0;  ///< directions that no surface fixes: along a corridor, one
  std::optional<Eigen::Vector3d> free_direction{};  ///< the freest, in the frame of the scan
  int matched = 0;  ///< points with a correspondence in the last step
  int inliers = 0;  ///< of these, within three sigma of their line
  bool converged = false;
};

/// Moves a scan onto a map from a start nearby: Gauss-Newton on the distances of its points from
/// the lines at their nearest neighbors (Censi, "An ICP variant using a point-to-line metric", ICRA
/// 2008), with the weights of Geman and McClure.
PointToLineMatch match_point_to_line(const PointMap& map, const std::vector<SurfacePoint>& scan,
                                     const Se2& T_map_scan, const PointToLineOptions& options = {});

}  // namespace cairn
