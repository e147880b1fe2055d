// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "frontends/laser/laser_loop_closer.hpp"

namespace cairn {

struct LaserKeyframe {
  std::int64_t stamp_ns;
  Se2 T_odom_laser;                   ///< in the tracker's own odometry frame
  std::vector<SurfacePoint> points;   ///< in the laser's frame
  Eigen::Matrix3d information;        ///< of the pose relative to the keyframe before
  Eigen::Matrix3d match_information;  ///< of the pose relative to the surfaces it was matched with
  /// To this one, from that at which the robot was last, if not at the one before: it was at known
  /// places since then.
  std::optional<LaserLoop> left{};
};

}  // namespace cairn
