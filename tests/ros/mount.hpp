// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/geometry/se2.hpp"

namespace cairn::test {

/// Where the tests' robot has its laser, and the same as a setting.
inline Se2 T_base_laser() { return {0.2, -0.1, 0.5}; }
inline constexpr const char* kLaserSetting = "laser=0.2/-0.1/28.64788975654116";

}  // namespace cairn::test
