// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/ros/ros_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <numbers>

#include "frontends/ros/complaints.hpp"

namespace cairn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(RosSettings, HaveTheDefaultsOfRos) {
  unsetenv("ROS_DOMAIN_ID");
  const auto settings = parse_ros_settings("");
  ASSERT_TRUE(settings);
  EXPECT_EQ(settings->domain, 0u);
  EXPECT_EQ(settings->scan, "rt/scan");
  EXPECT_EQ(settings->odometry, "rt/odom");
  EXPECT_EQ(settings->tf, "rt/tf");
  EXPECT_EQ(settings->tf_static, "rt/tf_static");
  EXPECT_FALSE(settings->T_base_laser);
}

TEST(RosSettings, AreRead) {
  const auto settings = parse_ros_settings(
      "domain=7,scan=/front/scan,odom=,tf=,tf_static=,trajectory=path,map_frame=m,odom_frame=o,"
      "laser=0.25/-1/90,tf_ahead_ms=0,interface=eth0");
  ASSERT_TRUE(settings) << settings.error().message;
  EXPECT_EQ(settings->domain, 7u);
  EXPECT_EQ(settings->network.interface, "eth0");
  EXPECT_EQ(settings->scan, "rt/front/scan");
  EXPECT_EQ(settings->odometry, "");
  EXPECT_EQ(settings->tf, "");
  EXPECT_EQ(settings->trajectory, "rt/path");
  EXPECT_EQ(settings->map_frame, "m");
  EXPECT_EQ(settings->odom_frame, "o");
  EXPECT_EQ(settings->T_base_laser->x(), 0.25);
  EXPECT_EQ(settings->T_base_laser->y(), -1.0);
  EXPECT_NEAR(settings->T_base_laser->theta(), 0.5 * std::numbers::pi, 1e-12);
  EXPECT_EQ(settings->tf_ahead.count(), 0);
}

TEST(RosSettings, TakeTheDomainOfTheEnvironment) {
  setenv("ROS_DOMAIN_ID", "42", 1);
  EXPECT_EQ(parse_ros_settings("")->domain, 42u);
  EXPECT_EQ(parse_ros_settings("domain=1")->domain, 1u);
  setenv("ROS_DOMAIN_ID", "4x", 1);
  const auto settings = parse_ros_settings("");
  ASSERT_FALSE(settings);
  EXPECT_THAT(settings.error().message, HasSubstr("ROS_DOMAIN_ID is '4x'; expected a number"));
  unsetenv("ROS_DOMAIN_ID");
}

TEST(RosSettings, SayWhatIsWrong) {
  const auto expect = [](const char* text, const char* message) {
    const auto settings = parse_ros_settings(text);
    ASSERT_FALSE(settings) << text;
    EXPECT_EQ(settings.error().code, ErrorCode::kUsage);
    EXPECT_THAT(settings.error().message, HasSubstr(message));
  };
  expect("speed=3", "'speed=3' is no setting; expected KEY=VALUE with one of domain, interface,");
  expect("scan", "'scan' is no setting");
  expect(",", "'' is no setting");
  expect("domain=231", "domain is '231'; expected a number from 0 to 230");
  expect("domain=-1", "domain is '-1'");
  expect("scan=", "scan is ''; expected a topic such as /name");
  expect("scan=a b", "scan is 'a b'");
  expect("odom=\x01", "odom is '\\x01'; expected a topic such as /name, or nothing for none");
  expect("map_frame=", "map_frame is ''");
  expect("laser=1/2", "laser is '1/2'; expected where the laser is on the robot: X/Y/YAW");
  expect("laser=1/2/nan", "laser is '1/2/nan'");
  expect("laser=1/2/3x", "laser is '1/2/3x'");
  expect("tf_ahead_ms=10001", "tf_ahead_ms is '10001'");
  expect("interface=", "interface is ''");
}

TEST(Complaints, AreToldOnceAndThenWithTheirNumber) {
  std::vector<std::string> told;
  Complaints complaints([&](const std::string& text) { told.push_back(text); });
  const auto now = Complaints::Clock::now();
  for (int i = 0; i < 5; ++i) complaints.add("scan", "bad", now);
  complaints.add("frame", "other", now);
  complaints.add("scan", "worse", now + Complaints::kPause);
  EXPECT_THAT(told, ElementsAre("bad", "other", "worse (6 times so far)"));
}

}  // namespace
}  // namespace cairn
