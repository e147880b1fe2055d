// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <string>

namespace cairn {

/// One odometry frame of one robot: a new epoch begins when the robot loses its odometry.
struct OdometryFrame {
  std::string robot;        ///< 1 to 64 bytes of UTF-8
  std::uint64_t epoch = 0;  ///< announced by the robot's one odometry source

  friend auto operator<=>(const OdometryFrame&, const OdometryFrame&) = default;
  friend bool operator==(const OdometryFrame&, const OdometryFrame&) = default;
};

/// Names a keyframe pose or a landmark, for everybody and for ever. For sensors the index is the
/// stamp in ns (a label), for files the file's id.
struct NodeId {
  OdometryFrame frame;
  std::uint64_t index = 0;

  friend auto operator<=>(const NodeId&, const NodeId&) = default;
  friend bool operator==(const NodeId&, const NodeId&) = default;
};

/// "robot/epoch/index", for people.
inline std::string to_string(const NodeId& node) {
  return node.frame.robot + '/' + std::to_string(node.frame.epoch) + '/' +
         std::to_string(node.index);
}

}  // namespace cairn

template <>
struct std::hash<cairn::NodeId> {
  std::size_t operator()(const cairn::NodeId& node) const noexcept {
    std::size_t seed = std::hash<std::string>{}(node.frame.robot);
    for (const std::uint64_t part : {node.frame.epoch, node.index})
      seed = (seed ^ part ^ part >> 32) * 0x9E3779B97F4A7C15ULL;
    return seed;
  }
};
