// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/geometry/se2.hpp"

namespace cairn::test {

/// Where the tests' robot has its laser.
inline Se2 T_base_laser() { return {0.2, -0.1, 0.5}; }

}  // namespace cairn::test
