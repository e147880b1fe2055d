// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "cairn/core/result.hpp"
#include "cairn/geometry/se2.hpp"
#include "frontends/api/laser_scan.hpp"
#include "idl/dds/ros_topics.hpp"

/// From ROS 2's messages, which anybody may have sent, to ours. README.md has the rules.
namespace cairn {

/// A scan without odometry: beams counterclockwise, no reading as 0, beams without echo as
/// max_range_m. kBadInput with what was found and what was expected.
Result<LaserScan> to_laser_scan(const ros::LaserScan& message);

struct StampedPose {
  std::int64_t stamp_ns = 0;
  Se2 T_odom_base{};
};

/// The planar part of an odometry pose. kBadInput where it is no pose.
Result<StampedPose> to_stamped_pose(const ros::Odometry& message);

}  // namespace cairn
