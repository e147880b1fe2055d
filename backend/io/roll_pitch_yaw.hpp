// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "cairn/geometry/so3.hpp"

namespace cairn {

/// Rotations as TORO and iSAM write them: roll, pitch, yaw in rad, R = Rz(yaw) Ry(pitch) Rx(roll).
So3 rotation_from_roll_pitch_yaw(const std::array<double, 3>& angles_rad);

/// Back again, pitch in [-pi/2, pi/2], rounded to 14 decimals, so that angles that were read are
/// written as they were.
std::array<double, 3> roll_pitch_yaw_from_rotation(const So3& rotation);

}  // namespace cairn
