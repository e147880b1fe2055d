// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/roll_pitch_yaw.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cairn {
namespace {

// Angles to and from a rotation are off by some 1e-15 rad; rounded to 14 decimals they come back as
// they were written, with the digits they were written with.
double round_decimals(double angle_rad, int decimals) {
  const double scale = std::pow(10.0, decimals);
  return std::round(angle_rad * scale) / scale;
}

// Half a turn has two names and roundings go from one to the other: it is written as +pi.
double round_turn(double angle_rad, int decimals) {
  const double rounded = round_decimals(angle_rad, decimals);
  return rounded == round_decimals(-std::numbers::pi, decimals) ? -rounded : rounded;
}

// Near gimbal lock (pitch = +-pi/2) only a sum of roll and yaw is determined, and roundings of roll
// grow by 1 / cos(pitch). Any roll within that is as good: take a rounder one.
int decimals_of_roll(double cos_pitch) {
  constexpr double kNoise = 2e-15;
  return static_cast<int>(std::floor(-std::log10(kNoise / std::max(cos_pitch, kNoise))));
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
  const Eigen::Matrix3d R = rotation.quaternion().normalized().toRotationMatrix();
  const int decimals = decimals_of_roll(std::hypot(R(2, 1), R(2, 2)));
  const double roll = round_turn(std::atan2(R(2, 1), R(2, 2)), decimals);
  const double c = std::cos(roll), s = std::sin(roll);
  // S = R Rx(roll)^T = Rz(yaw) Ry(pitch)
  const double S01 = c * R(0, 1) - s * R(0, 2), S11 = c * R(1, 1) - s * R(1, 2);
  const double S22 = s * R(2, 1) + c * R(2, 2);
  return {roll, round_decimals(std::atan2(0.0 - R(2, 0), S22), 14),
          round_turn(std::atan2(0.0 - S01, S11), 14)};
}

}  // namespace cairn
