// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "idl/dds/ros_topics.hpp"

namespace cairn::test {

/// A scan that owns what its message borrows. Every beam reads 2 m.
struct ScanMessage {
  std::string frame = "laser";
  std::vector<float> ranges;
  ros::LaserScan message{};

  explicit ScanMessage(std::size_t beams = 5, double first = -1.0, double step = 0.5)
      : ranges(beams, 2.0F) {
    message.header.stamp = {100, 0};
    message.angle_min = static_cast<float>(first);
    message.angle_increment = static_cast<float>(step);
    message.angle_max = static_cast<float>(first + static_cast<double>(beams - 1) * step);
    message.range_min = 0.1F;
    message.range_max = 10.0F;
    borrow();
  }
  ScanMessage(const ScanMessage&) = delete;
  /// After a change of `frame` or `ranges`.
  const ros::LaserScan& borrow() {
    message.header.frame_id = frame.data();
    message.ranges._buffer = ranges.data();
    message.ranges._length = message.ranges._maximum = static_cast<std::uint32_t>(ranges.size());
    return message;
  }
};

inline ros::Odometry odometry_message(std::int32_t sec, double x, double y, double yaw) {
  static std::string frame = "odom", child = "base_link";
  ros::Odometry message{};
  message.header = {{sec, 0}, frame.data()};
  message.child_frame_id = child.data();
  message.pose.pose = {{x, y, 0.0}, ros::to_quaternion(yaw)};
  return message;
}

}  // namespace cairn::test
