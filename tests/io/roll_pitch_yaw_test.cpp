// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/roll_pitch_yaw.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace cairn {
namespace {

using Angles = std::array<double, 3>;

Angles written_again(const Angles& angles_rad) {
  return roll_pitch_yaw_from_rotation(rotation_from_roll_pitch_yaw(angles_rad));
}

/// Angles close to where roundings matter: half turns, gimbal lock, none at all.
Angles delicate_angles(std::mt19937_64& random) {
  std::uniform_int_distribution<int> quarter(-2, 2), digits(0, 17);
  std::uniform_real_distribution<double> any(-4, 4), unit(-1, 1);
  Angles angles{};
  for (double& angle : angles)
    angle = digits(random) == 0 ? any(random)
                                : quarter(random) * std::numbers::pi / 2 +
                                      unit(random) * std::pow(10.0, -digits(random));
  return angles;
}

TEST(RollPitchYaw, StandsStillFromTheSecondWritingOn) {
  std::mt19937_64 random(20261123);
  for (int n = 0; n < 200000; ++n) {
    const Angles read = delicate_angles(random);
    const Angles second = written_again(written_again(read));
    ASSERT_EQ(written_again(second), second)
        << std::hexfloat << read[0] << ' ' << read[1] << ' ' << read[2];
    const So3 difference =
        rotation_from_roll_pitch_yaw(read).inverse() * rotation_from_roll_pitch_yaw(second);
    ASSERT_LT(difference.log().norm(), 1e-13);
  }
}

TEST(RollPitchYaw, NamesHalfATurnOneWay) {
  EXPECT_EQ(written_again({-3.14159265358979, 0, 0})[0], 3.14159265358979);
  EXPECT_EQ(written_again({0, 0, -3.14159265358979})[2], 3.14159265358979);
}

}  // namespace
}  // namespace cairn
