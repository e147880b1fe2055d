// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "cairn/core/result.hpp"
#include "cairn/geometry/se2.hpp"

namespace cairn {

/// What a keyframe keeps of one sweep of a planar range finder: all that a map needs beside the
/// keyframe's pose.
struct RangeScan {
  double first_angle_rad = 0.0, angle_step_rad = 0.0;  ///< of the beams, in the laser's frame
  double max_range_m = 0.0;     ///< a reading from here on says that there was no echo
  Se2 T_body_laser;             ///< where the laser sits on the robot
  std::vector<float> ranges_m;  ///< by beam; not finite or not positive: no reading
};

/// The type of such payloads.
inline constexpr std::string_view kRangeScanPayload = "laser_scan/1";
inline constexpr std::size_t kMaxBeams = 100'000;

/// The bytes of a payload (grammar: README.md); what is no reading becomes 0. Refuses what
/// decode_range_scan would refuse (kBadInput).
Result<std::string> encode(const RangeScan& scan);
/// The inverse. Refuses every string that encode() cannot have made (place: byte offset).
Result<RangeScan> decode_range_scan(std::string_view bytes);

}  // namespace cairn
