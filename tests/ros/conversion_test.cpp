// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numbers>

#include "frontends/ros/ros_messages.hpp"
#include "tests/ros/messages.hpp"

namespace cairn {
namespace {

using test::ScanMessage;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

TEST(RosScan, ReadsAnglesAndStamp) {
  ScanMessage scan;
  scan.message.header.stamp = {100, 250};
  const auto read = to_laser_scan(scan.message);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->stamp_ns, 100'000'000'250);
  EXPECT_EQ(read->first_angle_rad, -1.0);
  EXPECT_EQ(read->angle_step_rad, 0.5);
  EXPECT_EQ(read->max_range_m, 10.0);
  EXPECT_FALSE(read->T_odom_laser);
}

TEST(RosScan, KnowsEchoFromNoneAndFromNoReading) {
  ScanMessage scan(9, -1.0, 0.25);
  scan.ranges = {2.0F, kInf, -kInf, kNaN, 0.05F, 0.0F, -3.0F, 11.0F, 10.0F};
  const auto read = to_laser_scan(scan.borrow());
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_THAT(read->ranges_m, ElementsAre(2.0F, 10.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 10.0F, 10.0F));
}

TEST(RosScan, TurnsClockwiseBeamsAround) {
  ScanMessage scan(3, 1.0, -0.5);
  scan.ranges = {1.0F, 2.0F, 3.0F};
  const auto read = to_laser_scan(scan.borrow());
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->first_angle_rad, 0.0);
  EXPECT_EQ(read->angle_step_rad, 0.5);
  EXPECT_THAT(read->ranges_m, ElementsAre(3.0F, 2.0F, 1.0F));
}

TEST(RosScan, TakesAWholeTurnWithOrWithoutItsLastBeam) {
  const double step = 2.0 * std::numbers::pi / 360.0;
  ScanMessage without(360, 0.0, step), with(361, 0.0, step);
  without.message.angle_max = with.message.angle_max;
  EXPECT_TRUE(to_laser_scan(without.message));
  EXPECT_TRUE(to_laser_scan(with.message));
}

TEST(RosScan, SaysWhatIsWrong) {
  struct Case {
    const char* message;
    std::function<void(ScanMessage&)> break_it;
  };
  const std::vector<Case> cases{
      {"angle_increment is 0 rad", [](auto& s) { s.message.angle_increment = 0.0F; }},
      {"angle_increment is nan rad", [](auto& s) { s.message.angle_increment = kNaN; }},
      {"angle_increment is inf rad", [](auto& s) { s.message.angle_increment = kInf; }},
      {"angle_increment 0.5 are not those of its 9 ranges", [](auto& s) { s.ranges.resize(9); }},
      {"angle_increment 0.7 are not those",
       [](auto& s) {
         s.message.angle_increment = 0.7F;
         s.message.angle_max = 3.5F;
       }},
      {"the angles go from nan", [](auto& s) { s.message.angle_min = kNaN; }},
      {"to inf rad", [](auto& s) { s.message.angle_max = kInf; }},
      {"go around more than once",
       [](auto& s) {
         s.ranges.resize(20);
         s.message.angle_max = 8.5F;
       }},
      {"it has 0 ranges; expected 2 to 100000", [](auto& s) { s.ranges.clear(); }},
      {"it has 1 ranges", [](auto& s) { s.ranges.resize(1); }},
      {"it has 100001 ranges", [](auto& s) { s.ranges.resize(100'001); }},
      {"range_max is inf m", [](auto& s) { s.message.range_max = kInf; }},
      {"range_max is nan m", [](auto& s) { s.message.range_max = kNaN; }},
      {"range_max is 0 m", [](auto& s) { s.message.range_max = 0.0F; }},
      {"range_max is 20000 m", [](auto& s) { s.message.range_max = 20'000.0F; }},
      {"range_min is nan m", [](auto& s) { s.message.range_min = kNaN; }},
      {"range_min is 10 m; expected 0 up to", [](auto& s) { s.message.range_min = 10.0F; }},
      {"its stamp is -1 s", [](auto& s) { s.message.header.stamp.sec = -1; }},
      {"and 1000000000 ns", [](auto& s) { s.message.header.stamp.nanosec = 1'000'000'000; }},
  };
  for (const Case& c : cases) {
    ScanMessage scan;
    c.break_it(scan);
    const auto read = to_laser_scan(scan.borrow());
    ASSERT_FALSE(read) << c.message;
    EXPECT_THAT(read.error().message, HasSubstr(c.message));
    EXPECT_EQ(read.error().code, ErrorCode::kBadInput);
  }
}

TEST(RosOdometry, ReadsThePlanarPart) {
  ros::Odometry message = test::odometry_message(5, 1.0, -2.0, 0.0);
  // Yaw 0.5 after a roll of a half turn: what the quaternion's z and w alone would get wrong.
  message.pose.pose.orientation = {std::cos(0.25), std::sin(0.25), 0.0, 0.0};
  auto read = to_stamped_pose(message);
  ASSERT_TRUE(read);
  EXPECT_NEAR(read->T_odom_base.theta(), 0.5, 1e-12);
  read = to_stamped_pose(test::odometry_message(5, 1.0, -2.0, -3.0));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->stamp_ns, 5'000'000'000);
  EXPECT_EQ(read->T_odom_base.x(), 1.0);
  EXPECT_NEAR(read->T_odom_base.theta(), -3.0, 1e-12);
}

TEST(RosOdometry, SaysWhatIsWrong) {
  const auto message_of = [](const ros::Odometry& odometry) {
    const auto read = to_stamped_pose(odometry);
    return read ? std::string("none") : read.error().message;
  };
  ros::Odometry odometry = test::odometry_message(5, 1.0, kNaN, 0.0);
  EXPECT_THAT(message_of(odometry), HasSubstr("its position is 1 nan 0"));
  odometry = test::odometry_message(5, 1e9, 0.0, 0.0);
  EXPECT_THAT(message_of(odometry), HasSubstr("at most 1e7"));
  odometry = test::odometry_message(5, 0.0, 0.0, 0.0);
  odometry.pose.pose.orientation = {};
  EXPECT_THAT(message_of(odometry), HasSubstr("its orientation has the norm 0"));
  odometry.pose.pose.orientation = {kNaN, 0.0, 0.0, 1.0};
  EXPECT_THAT(message_of(odometry), HasSubstr("the norm nan"));
  odometry = test::odometry_message(-5, 0.0, 0.0, 0.0);
  EXPECT_THAT(message_of(odometry), HasSubstr("its stamp is -5 s"));
}

}  // namespace
}  // namespace cairn
