// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <span>

#include "cairn/geometry/se2.hpp"

namespace cairn {

/// Where a pose lies on the ground, and where it heads. `pose`: x y theta, or x y z qx qy qz qw.
inline Se2 ground_pose(std::span<const double> pose) {
  if (pose.size() == 3) return {pose[0], pose[1], pose[2]};
  const double x = pose[3], y = pose[4], z = pose[5], w = pose[6];
  const double yaw_rad = std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
  return {pose[0], pose[1], yaw_rad};
}

}  // namespace cairn
