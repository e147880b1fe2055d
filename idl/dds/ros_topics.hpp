// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros2/nav_msgs.h>
#include <ros2/sensor_msgs.h>
#include <ros2/tf2_msgs.h>

#include <cstdint>
#include <string>

#include "cairn/core/result.hpp"
#include "cairn/geometry/se2.hpp"
#include "idl/dds/endpoint.hpp"

/// Topics of ROS 2 nodes, without ROS: its names and types over DDS. idl/README.md has the table.
namespace cairn::ros {

using LaserScan = sensor_msgs_msg_dds__LaserScan_;
using Odometry = nav_msgs_msg_dds__Odometry_;
using Path = nav_msgs_msg_dds__Path_;
using OccupancyGrid = nav_msgs_msg_dds__OccupancyGrid_;
using OccupancyGridUpdate = map_msgs_msg_dds__OccupancyGridUpdate_;
using TFMessage = tf2_msgs_msg_dds__TFMessage_;
using Header = std_msgs_msg_dds__Header_;
using Time = builtin_interfaces_msg_dds__Time_;
using Pose = geometry_msgs_msg_dds__Pose_;
using Quaternion = geometry_msgs_msg_dds__Quaternion_;

/// The descriptor of a generated ROS type.
template <class T>
const dds_topic_descriptor_t* descriptor_of();

/// `topic` as DDS knows it ("rt/scan") lives while endpoints are made.
template <class T>
dds::Endpoint::Description describe(const std::string& topic, dds::Traffic traffic) {
  return {topic.c_str(), descriptor_of<T>(), traffic};
}

/// "rt/scan" for "scan" and "/scan". kUsage where that is no name of a ROS topic (letters, digits,
/// '_' and '/', at most 200 of them).
Result<std::string> topic_name(const std::string& name);

/// $ROS_DOMAIN_ID, or 0 where it is not set. kUsage where it is no number from 0 to 230.
Result<std::uint32_t> domain_of_environment();

/// Of a stamp before 1970 or with a billion nanoseconds: nothing. A label, never differentiated.
std::optional<std::int64_t> stamp_ns(const Time& time);
/// Beyond what 32 bits of seconds hold: the nearest that they do.
Time to_time(std::int64_t stamp_ns);

Pose to_pose(const Se2& T);
Quaternion to_quaternion(double yaw_rad);

}  // namespace cairn::ros
