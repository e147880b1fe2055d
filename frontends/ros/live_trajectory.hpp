// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "frontends/api/frontend.hpp"

namespace cairn {

/// One robot's planar trajectory since its odometry frame began: keyframes where the daemon has put
/// them, and newer ones by odometry from the newest of those. One thread.
class LiveTrajectory {
 public:
  struct Keyframe {
    std::int64_t stamp_ns = 0;
    Se2 T_odom_body{};  ///< in the front-end's odometry frame
    std::optional<Se2> T_map_body{};
  };

  explicit LiveTrajectory(OdometryFrame frame = {}) : frame_(std::move(frame)) {}

  void add(const Transaction& keyframe);
  /// True where a pose of this robot changed.
  bool update(const MapSnapshot& snapshot);

  /// Nothing of a keyframe that it does not know.
  [[nodiscard]] std::optional<Se2> T_map_body(const LocalizedFrame& where) const;
  [[nodiscard]] const std::map<std::uint64_t, Keyframe>& keyframes() const { return keyframes_; }
  [[nodiscard]] Se2 T_map_body(const Keyframe& keyframe) const {
    return keyframe.T_map_body.value_or(T_map_odom_ * keyframe.T_odom_body);
  }

 private:
  OdometryFrame frame_;
  std::map<std::uint64_t, Keyframe> keyframes_;  ///< by index of their node
  Se2 T_map_odom_;                               ///< at the newest keyframe with a pose in the map
};

}  // namespace cairn
