// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include "cairn/geometry/se2.hpp"
#include "cairn/io/time_stamp.hpp"

namespace cairn {

constexpr const char* kTumHeader = "# stamp tx ty tz qx qy qz qw\n";

/// A pose in the plane as a line of a TUM trajectory, m.
inline std::string tum_line(std::int64_t stamp_ns, const Se2& T) {
  char line[160];
  std::snprintf(line, sizeof line, " %.9f %.9f 0 0 0 %.12f %.12f\n", T.x(), T.y(),
                std::sin(0.5 * T.theta()), std::cos(0.5 * T.theta()));
  return format_stamp(stamp_ns) + line;
}

}  // namespace cairn
