// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "idl/messages.hpp"

namespace cairn {

/// T_map_odom as it can be steered by: follows the daemon's corrections at a limited rate, so that
/// the robot's place in the map does not jump under it. The limit holds where the robot is, and not
/// at the origin of its odometry frame, which may be far away. One thread.
class SmoothedCorrection {
 public:
  struct Rate {
    double m_per_s = 0.1;
    double rad_per_s = 0.05;
  };

  explicit SmoothedCorrection(Rate rate) : rate_(rate) {}

  /// The first one, and one of another frame or map, holds at once: there is nothing to go on from.
  void take(const Correction& correction);

  /// For a robot at T_odom_body (numbers as in Correction) at a time (ns, of any steady clock;
  /// times that go back change nothing). Nothing before the first correction.
  std::optional<PoseNumbers> T_map_odom(std::int64_t now_ns, const PoseNumbers& T_odom_body);

  /// The newest correction holds in full.
  [[nodiscard]] bool settled() const;

 private:
  Rate rate_;
  std::optional<Correction> target_;
  PoseNumbers now_{};  ///< T_map_odom
  std::optional<std::int64_t> asked_ns_;
};

}  // namespace cairn
