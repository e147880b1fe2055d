// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "frontends/api/laser_scan.hpp"

namespace cairn {

/// A point of a surface that a laser has seen.
struct SurfacePoint {
  Eigen::Vector2d position;
  Eigen::Vector2d
      normal;  ///< of unit length, towards the laser; zero where no line fits its neighbors
  double normal_variance = 0.0;  ///< rad^2, of its direction as measured
  double to_line_m = 0.0;        ///< from the echo to the line of its neighbors, along the normal
};

struct ScanPointOptions {
  double nearest_m = 0.15, farthest_m = 30.0;
  double gap_m = 0.4;          ///< neighboring echoes that are further apart are of two surfaces
  double line_radius_m = 0.3;  ///< of the neighbors that make a line
};

/// The echoes of a scan in the laser's frame, in the order of its beams.
std::vector<SurfacePoint> surface_points(const LaserScan& scan,
                                         const ScanPointOptions& options = {});

/// The same points elsewhere.
std::vector<SurfacePoint> moved(const Se2& T, const std::vector<SurfacePoint>& points);

}  // namespace cairn
