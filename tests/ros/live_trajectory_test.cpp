// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/ros/live_trajectory.hpp"

#include <gtest/gtest.h>

#include "cairn/factors/build_transaction.hpp"

namespace cairn {
namespace {

const OdometryFrame kFrame{"kestrel", 7};

Transaction keyframe(std::uint64_t index, const Se2& T_odom_body) {
  Transaction transaction;
  add_pose(transaction, {kFrame, index}, T_odom_body, static_cast<std::int64_t>(index));
  transaction.variables.back().odometry = transaction.variables.back().start;
  return transaction;
}

MapSnapshot snapshot(const OdometryFrame& frame, std::uint64_t index, double x, double yaw) {
  MapSnapshot snapshot;
  snapshot.changed.push_back({.frame = frame, .poses = {{index, 0, {x, 0.0, yaw}}}});
  return snapshot;
}

bool near(const std::optional<Se2>& a, const Se2& b) {
  return a && (a->to_vector() - b.to_vector()).isZero(1e-12);
}

TEST(LiveTrajectory, GoesOnByOdometryFromTheNewestOptimizedKeyframe) {
  LiveTrajectory trajectory(kFrame);
  for (std::uint64_t i = 0; i < 4; ++i)
    trajectory.add(keyframe(i, Se2(static_cast<double>(i), 0.0, 0.0)));
  const LocalizedFrame where{0, {kFrame, 3}, Se2(0.5, 0.0, 0.0)};
  EXPECT_TRUE(near(trajectory.T_map_body(where), Se2(3.5, 0.0, 0.0)));  // nothing is told yet
  EXPECT_TRUE(trajectory.update(snapshot(kFrame, 1, 10.0, 1.0)));
  const Se2 T_map_odom = Se2(10.0, 0.0, 1.0) * Se2(1.0, 0.0, 0.0).inverse();
  EXPECT_TRUE(near(trajectory.T_map_body(where), T_map_odom * Se2(3.5, 0.0, 0.0)));
  EXPECT_TRUE(trajectory.update(snapshot(kFrame, 3, 20.0, 0.0)));
  EXPECT_TRUE(near(trajectory.T_map_body(where), Se2(20.5, 0.0, 0.0)));
  EXPECT_EQ(trajectory.T_map_body(trajectory.keyframes().at(1)).x(), 10.0);
}

TEST(LiveTrajectory, IsOfOneRobotAndOneEpoch) {
  LiveTrajectory trajectory(kFrame);
  trajectory.add(keyframe(0, Se2()));
  EXPECT_FALSE(trajectory.update(snapshot({"kestrel", 8}, 0, 10.0, 0.0)));
  EXPECT_FALSE(trajectory.update(snapshot({"merlin", 7}, 0, 10.0, 0.0)));
  EXPECT_FALSE(trajectory.update(snapshot(kFrame, 5, 10.0, 0.0)));
  EXPECT_FALSE(trajectory.T_map_body(LocalizedFrame{0, {kFrame, 1}, Se2()}));
  EXPECT_FALSE(trajectory.T_map_body(LocalizedFrame{0, {{"kestrel", 8}, 0}, Se2()}));
}

}  // namespace
}  // namespace cairn
