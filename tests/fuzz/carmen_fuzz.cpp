// SPDX-License-Identifier: BSD-3-Clause
// Reads CARMEN logs; what is read has angles, a largest range, and odometry that is finite.
#include <cmath>
#include <cstdlib>

#include "frontends/carmen/carmen_log.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const auto log = cairn::read_carmen_text({reinterpret_cast<const char*>(data), size}, "fuzz", {});
  if (!log) return 0;
  if (log->scans.empty() || log->warnings.size() > 20) std::abort();
  for (const cairn::LaserScan& scan : log->scans) {
    const bool sound = scan.angle_step_rad > 0.0 && std::isfinite(scan.first_angle_rad) &&
                       scan.max_range_m > 0.0 && scan.stamp_ns >= 0 && !scan.ranges_m.empty();
    if (!sound) std::abort();
    if (scan.T_odom_laser && !scan.T_odom_laser->to_vector().allFinite()) std::abort();
  }
  return 0;
}
