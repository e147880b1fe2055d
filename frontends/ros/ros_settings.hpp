// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "cairn/core/result.hpp"
#include "cairn/geometry/se2.hpp"
#include "idl/dds/entity.hpp"

namespace cairn {

/// Which topics of which robot; README.md has the table. Names of topics are those of DDS
/// ("rt/scan").
struct RosSettings {
  std::uint32_t domain = 0;
  dds::Network network{};
  std::string scan = "rt/scan";
  std::string odometry = "rt/odom";          ///< empty: none
  std::string tf = "rt/tf";                  ///< empty: not published
  std::string trajectory = "rt/trajectory";  ///< empty: not published
  std::string map_frame = "map", odom_frame = "odom";
  std::string tf_static = "rt/tf_static";   ///< empty: not listened to
  std::optional<Se2> T_base_laser{};        ///< nothing: from tf_static
  std::chrono::milliseconds tf_ahead{200};  ///< transforms are stamped so much after their scan
};

/// "KEY=VALUE,KEY=VALUE", or nothing. The domain's default is $ROS_DOMAIN_ID. kUsage with the keys
/// there are and what they take.
Result<RosSettings> parse_ros_settings(const std::string& text);

}  // namespace cairn
