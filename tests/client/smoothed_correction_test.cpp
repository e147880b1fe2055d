// SPDX-License-Identifier: BSD-3-Clause
#include "clients/client/smoothed_correction.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "cairn/geometry/se2.hpp"
#include "cairn/geometry/se3.hpp"

namespace cairn {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

Correction planar(double x, double y, double theta) {
  return {.frame = {"robot", 1}, .map = "robot/1", .T_map_odom = {x, y, theta}};
}

Se2 se2(const PoseNumbers& x) { return {x[0], x[1], x[2]}; }

TEST(SmoothedCorrection, TakesTheFirstAtOnceAndOthersAtTheRate) {
  SmoothedCorrection smoothed({.m_per_s = 0.1, .rad_per_s = 0.05});
  const PoseNumbers body{3.0, 0.0, 0.0};
  EXPECT_FALSE(smoothed.T_map_odom(0, body));
  smoothed.take(planar(1.0, 2.0, 0.0));
  EXPECT_EQ(*smoothed.T_map_odom(0, body), (PoseNumbers{1.0, 2.0, 0.0}));
  EXPECT_TRUE(smoothed.settled());
  smoothed.take(planar(2.0, 2.0, 0.0));
  EXPECT_FALSE(smoothed.settled());
  EXPECT_NEAR((*smoothed.T_map_odom(kSecond, body))[0], 1.1, 1e-12);
  EXPECT_NEAR((*smoothed.T_map_odom(kSecond, body))[0], 1.1, 1e-12);      // no time has passed
  EXPECT_NEAR((*smoothed.T_map_odom(kSecond / 2, body))[0], 1.1, 1e-12);  // nor ran it back
  EXPECT_NEAR((*smoothed.T_map_odom(3 * kSecond / 2, body))[0], 1.2, 1e-12);
  EXPECT_EQ(*smoothed.T_map_odom(60 * kSecond, body), (PoseNumbers{2.0, 2.0, 0.0}));
  EXPECT_TRUE(smoothed.settled());
}

// A turn of the map about an origin that is a kilometre away.
TEST(SmoothedCorrection, LimitsTheMotionWhereTheRobotIs) {
  SmoothedCorrection smoothed({.m_per_s = 0.1, .rad_per_s = 0.05});
  const PoseNumbers body{1000.0, -300.0, 2.0};
  smoothed.take(planar(0.0, 0.0, 0.0));
  Se2 before = se2(*smoothed.T_map_odom(0, body)) * se2(body);
  smoothed.take(planar(0.0, 0.0, 0.01));  // 10 m for the robot
  int steps = 0;
  while (!smoothed.settled() && steps < 10'000) {
    const Se2 after = se2(*smoothed.T_map_odom(++steps * kSecond / 10, body)) * se2(body);
    const Se2 moved = before.inverse() * after;
    EXPECT_LE(moved.translation().norm(), 0.01 + 1e-9);
    EXPECT_LE(std::abs(moved.theta()), 0.005 + 1e-9);
    before = after;
  }
  EXPECT_NEAR(steps, 1044, 2);  // the way of 10.44 m at 0.1 m/s
}

TEST(SmoothedCorrection, TurnsInSpaceAtTheRate) {
  SmoothedCorrection smoothed({.m_per_s = 1.0, .rad_per_s = 0.05});
  Correction correction{.frame = {"robot", 1}, .map = "robot/1", .type = VariableType::kPose3};
  correction.T_map_odom = {0, 0, 0, 0, 0, 0, 1};
  const PoseNumbers body{0, 0, 0, 0, 0, 0, 1};
  smoothed.take(correction);
  ASSERT_TRUE(smoothed.T_map_odom(0, body));
  const double angle = 0.2;
  correction.T_map_odom = {0, 0, 0, 0, std::sin(angle / 2), 0, std::cos(angle / 2)};
  smoothed.take(correction);
  const PoseNumbers after = *smoothed.T_map_odom(kSecond, body);
  EXPECT_NEAR(2 * std::atan2(after[4], after[6]), 0.05, 1e-12);
  EXPECT_EQ(*smoothed.T_map_odom(10 * kSecond, body), correction.T_map_odom);
}

TEST(SmoothedCorrection, DoesNotGoFromOneMapToAnother) {
  SmoothedCorrection smoothed({.m_per_s = 0.1, .rad_per_s = 0.05});
  smoothed.take(planar(1.0, 0.0, 0.0));
  ASSERT_TRUE(smoothed.T_map_odom(0, {}));
  Correction other = planar(50.0, 0.0, 0.0);
  other.map = "leader/1";
  smoothed.take(other);
  EXPECT_EQ(*smoothed.T_map_odom(1, {}), other.T_map_odom);
  EXPECT_TRUE(smoothed.settled());
}

}  // namespace
}  // namespace cairn
