// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "cairn/geometry/se2.hpp"

namespace cairn {

/// One sweep of a planar laser range finder.
struct LaserScan {
  std::int64_t stamp_ns = 0;  ///< a label: may repeat, and go back a little
  double first_angle_rad = 0.0, angle_step_rad = 0.0;  ///< of the beams, in the laser's frame
  double max_range_m = 0.0;                            ///< readings from here on are no echo
  std::vector<float> ranges_m;        ///< by beam; not finite or not positive: no reading
  std::optional<Se2> T_odom_laser{};  ///< where odometry says the laser was
};

}  // namespace cairn
