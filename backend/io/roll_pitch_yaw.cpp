// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/roll_pitch_yaw.hpp"

#include <algorithm>
#include <cmath>

#include "cairn/io/settle.hpp"

namespace cairn {
namespace {

// Near gimbal lock (pitch = +-pi/2) only a sum of roll and yaw is determined, and roundings of roll grow
// by 1 / cos(pitch). Any roll within that is as good: take a round one, so that it comes out again.
double steady_roll(const Eigen::Matrix3d& R) {
  constexpr double kNearLock = 0.1;
  const double roll = std::atan2(R(2, 1), R(2, 2));
  const double cos_pitch = std::hypot(R(2, 1), R(2, 2));
  if (cos_pitch > kNearLock) return roll;
  const double grain = std::exp2(std::ceil(std::log2(1e-14 / std::max(cos_pitch, 1e-14))));
  return std::round(roll / grain) * grain;
}

std::array<double, 3> to_angles(const So3& rotation) {
  const Eigen::Matrix3d R = rotation.matrix();
  const double roll = steady_roll(R), c = std::cos(roll), s = std::sin(roll);
  // S = R Rx(roll)^T = Rz(yaw) Ry(pitch)
  const double S01 = c * R(0, 1) - s * R(0, 2), S11 = c * R(1, 1) - s * R(1, 2);
  const double S22 = s * R(2, 1) + c * R(2, 2);
  return {roll, std::atan2(0.0 - R(2, 0), S22), std::atan2(0.0 - S01, S11)};
}

}  // namespace

So3 rotation_from_roll_pitch_yaw(const std::array<double, 3>& angles_rad) {
  const auto about = [](double angle_rad, const Eigen::Vector3d& axis) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis));
  };
  return So3(about(angles_rad[2], Eigen::Vector3d::UnitZ()) *
             about(angles_rad[1], Eigen::Vector3d::UnitY()) *
             about(angles_rad[0], Eigen::Vector3d::UnitX()));
}

std::array<double, 3> roll_pitch_yaw_from_rotation(const So3& rotation) {
  return settle(to_angles(rotation), [](const std::array<double, 3>& angles) {
    return to_angles(rotation_from_roll_pitch_yaw(angles));
  });
}

}  // namespace cairn
