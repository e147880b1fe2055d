// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/ros/static_transforms.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

namespace cairn {
namespace {

constexpr double kQuarter = 0.5 * std::numbers::pi;
using Rotation = Eigen::AngleAxisd;
const Eigen::Vector3d kX = Eigen::Vector3d::UnitX(), kY = Eigen::Vector3d::UnitY(),
                      kZ = Eigen::Vector3d::UnitZ();

void add(StaticTransforms& all, std::string parent, std::string child, const Eigen::Vector3d& t,
         const Eigen::Quaterniond& q = Eigen::Quaterniond::Identity()) {
  geometry_msgs_msg_dds__TransformStamped_ transform{};
  transform.header.frame_id = parent.data();
  transform.child_frame_id = child.data();
  transform.transform = {{t.x(), t.y(), t.z()}, {q.x(), q.y(), q.z(), q.w()}};
  ros::TFMessage message{};
  message.transforms._buffer = &transform;
  message.transforms._length = message.transforms._maximum = 1;
  all.add(message);
}

TEST(StaticTransforms, LeadFromFrameToFrame) {
  StaticTransforms all;
  add(all, "base_footprint", "base_link", {0, 0, 0.1});
  add(all, "base_link", "mast", {1, 0, 1}, Eigen::Quaterniond(Rotation(kQuarter, kZ)));
  add(all, "/mast", "/laser", {2, 0, 0});
  add(all, "base_link", "camera", {-1, 0, 0});
  const auto T_base_laser = all.T_a_b("base_link", "laser");
  ASSERT_TRUE(T_base_laser);
  EXPECT_TRUE(T_base_laser->translation().isApprox(Eigen::Vector3d(1, 2, 1)));
  EXPECT_TRUE(all.T_a_b("laser", "base_link")->translation().isApprox(Eigen::Vector3d(-2, 1, -1)));
  EXPECT_TRUE(all.T_a_b("camera", "laser")->translation().isApprox(Eigen::Vector3d(2, 2, 1)));
  EXPECT_TRUE(all.T_a_b("lone", "lone"));
  EXPECT_FALSE(all.T_a_b("base_link", "lone"));
  add(all, "mast", "laser", {3, 0, 0});
  EXPECT_TRUE(all.T_a_b("mast", "laser")->translation().isApprox(Eigen::Vector3d(3, 0, 0)));
}

TEST(StaticTransforms, LeaveOutWhatIsNone) {
  const double nan = std::nan("");
  StaticTransforms all;
  add(all, "base", "laser", {nan, 0, 0});
  add(all, "base", "laser", {1e9, 0, 0});
  add(all, "base", "laser", {0, 0, 0}, Eigen::Quaterniond(0, 0, 0, 0));
  add(all, "base", "laser", {0, 0, 0}, Eigen::Quaterniond(nan, 0, 0, 0));
  EXPECT_FALSE(all.T_a_b("base", "laser"));
  add(all, "a", "b", {1, 0, 0});  // a circle
  add(all, "b", "a", {1, 0, 0});
  add(all, "c", "c", {1, 0, 0});
  EXPECT_FALSE(all.T_a_b("a", "b"));
  EXPECT_TRUE(all.T_a_b("c", "c")->translation().isZero());
  for (std::size_t i = 0; i < 2 * StaticTransforms::kMost; ++i)
    add(all, "base", "f" + std::to_string(i), {1, 0, 0});
  EXPECT_TRUE(all.T_a_b("base", "f10"));
  EXPECT_FALSE(all.T_a_b("base", "f" + std::to_string(StaticTransforms::kMost)));
}

TEST(LaserMount, IsSeenFromAbove) {
  const Eigen::Quaterniond level(Rotation(0.3, kZ));
  LaserMount mount = to_mount(Se3(So3(level), {1, 2, 3}));
  EXPECT_NEAR(mount.T_base_laser.theta(), 0.3, 1e-12);
  EXPECT_EQ(mount.T_base_laser.y(), 2.0);
  EXPECT_FALSE(mount.upside_down);
  EXPECT_NEAR(mount.tilt_rad, 0.0, 1e-6);
  mount = to_mount(Se3(So3(level * Rotation(std::numbers::pi, kX)), {0, 0, 0}));
  EXPECT_TRUE(mount.upside_down);
  EXPECT_NEAR(mount.T_base_laser.theta(), 0.3, 1e-12);
  EXPECT_NEAR(mount.tilt_rad, 0.0, 1e-6);
  mount = to_mount(Se3(So3(level * Rotation(0.2, kY)), {0, 0, 0}));
  EXPECT_NEAR(mount.tilt_rad, 0.2, 1e-9);
}

// Where each echo lies must not depend on how the laser hangs.
TEST(LaserMount, EchoesOfALaserUpsideDownStayWhereTheyAre) {
  const Se3 T_base_laser(
      So3(Eigen::Quaterniond(Rotation(0.3, kZ) * Rotation(std::numbers::pi, kX))), {1, 2, 3});
  LaserScan scan;
  scan.first_angle_rad = -0.5;
  scan.angle_step_rad = 0.25;
  scan.ranges_m = {1.0F, 2.0F, 3.0F, 4.0F};
  std::vector<Eigen::Vector2d> before, after;
  for (std::size_t i = 0; i < 4; ++i) {
    const double angle = -0.5 + 0.25 * static_cast<double>(i), range = scan.ranges_m[i];
    before.emplace_back(
        (T_base_laser * Eigen::Vector3d(range * std::cos(angle), range * std::sin(angle), 0.0))
            .head<2>());
  }
  turn_upright(scan);
  const Se2 upright = to_mount(T_base_laser).T_base_laser;
  for (std::size_t i = 4; i-- > 0;) {
    const double angle = scan.first_angle_rad + scan.angle_step_rad * static_cast<double>(i);
    after.emplace_back(upright * Eigen::Vector2d(scan.ranges_m[i] * std::cos(angle),
                                                 scan.ranges_m[i] * std::sin(angle)));
  }
  for (std::size_t i = 0; i < 4; ++i) EXPECT_TRUE(before[i].isApprox(after[i], 1e-9)) << i;
}

}  // namespace
}  // namespace cairn
