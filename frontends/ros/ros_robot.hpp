// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "frontends/host/frame_source.hpp"

namespace cairn {

/// A ROS 2 robot's laser and odometry as a live source of frames, and where the robot is in the map
/// as its answer. `settings` as in ros_settings.hpp; `daemon_domain` is that of the Cairn daemon.
Result<std::unique_ptr<FrameSource>> open_ros_robot(const std::string& settings,
                                                    std::uint32_t daemon_domain);

}  // namespace cairn
