// SPDX-License-Identifier: BSD-3-Clause
// The live source over real DDS, with whoever may publish on a robot's topics.
#include "frontends/ros/ros_robot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <thread>

#include "frontends/ros/scan_queue.hpp"
#include "tests/ros/messages.hpp"
#include "tests/support/own_domain.hpp"

namespace cairn {
namespace {

using dds::Traffic;
using test::ScanMessage;
using testing::HasSubstr;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

class RosRobot : public testing::Test {
 protected:
  void open(const std::string& more = "") {
    const std::string settings = "domain=" + std::to_string(test::own_domain()) + more;
    auto opened = open_ros_robot(settings, 230);
    ASSERT_TRUE(opened) << opened.error().message;
    robot_ = std::move(*opened);
    auto participant = dds::Participant::open(test::own_domain(), {});
    ASSERT_TRUE(participant);
    participant_.emplace(std::move(*participant));
    // Reliable, so that nothing of the test is lost on the way.
    scans_ = make_writer<ros::LaserScan>("rt/scan");
    if (more.find("odom=") == std::string::npos) odometry_ = make_writer<ros::Odometry>("rt/odom");
  }
  template <class T>
  std::optional<dds::Writer<T>> make_writer(const std::string& topic,
                                            Traffic traffic = Traffic::kTransforms) {
    auto made = dds::Writer<T>::make(*participant_, ros::describe<T>(topic, traffic), &trouble_);
    EXPECT_TRUE(made);
    dds_publication_matched_status_t matched{};
    while (dds_get_publication_matched_status(made->handle(), &matched) >= 0 &&
           matched.current_count == 0)
      dds_sleepfor(DDS_MSECS(1));
    dds_sleepfor(DDS_MSECS(50));  // best-effort readers match later, and nobody says when
    return std::move(*made);
  }
  void send(ScanMessage& scan) { EXPECT_EQ(scans_->write(scan.borrow()), DDS_RETCODE_OK); }
  void send(const ros::Odometry& odometry) {
    EXPECT_EQ(odometry_->write(odometry), DDS_RETCODE_OK);
  }
  std::optional<LaserScan> next() {
    for (int turn = 0; turn < 50; ++turn) {
      const auto next = robot_->next();
      EXPECT_TRUE(next);
      if (!next) return std::nullopt;
      if (const auto* frame = std::get_if<SensorFrame>(&*next)) return std::get<LaserScan>(*frame);
    }
    return std::nullopt;
  }

  dds::TroubleHandler trouble_;
  std::unique_ptr<FrameSource> robot_;
  std::optional<dds::Participant> participant_;
  std::optional<dds::Writer<ros::LaserScan>> scans_;
  std::optional<dds::Writer<ros::Odometry>> odometry_;
};

TEST_F(RosRobot, GivesScansWithTheirOdometryInOrderOfArrival) {
  open(",laser=1/0/0");
  EXPECT_TRUE(robot_->is_live());
  send(test::odometry_message(100, 5.0, 0.0, 0.0));
  ScanMessage scan;
  send(scan);
  scan.message.header.stamp = {99, 500'000'000};  // goes back, and has no odometry
  send(scan);
  const auto first = next(), second = next();
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->stamp_ns, 100'000'000'000);
  ASSERT_TRUE(first->T_odom_laser);
  EXPECT_EQ(first->T_odom_laser->x(), 6.0);
  EXPECT_EQ(second->stamp_ns, 99'500'000'000);
  EXPECT_FALSE(second->T_odom_laser);
}

TEST_F(RosRobot, SaysNothingYetWhereNothingComes) {
  open();
  const auto next = robot_->next();
  ASSERT_TRUE(next);
  EXPECT_TRUE(std::holds_alternative<NothingYet>(*next));
}

TEST_F(RosRobot, LeavesOutWhatNoScanIsAndSaysSo) {
  testing::internal::CaptureStderr();
  open(",odom=");
  ScanMessage good, still, huge, other;
  still.message.angle_increment = 0.0F;
  huge.ranges.resize(200'000);
  other.frame = "laser\n\x1b[31m" + std::string(500, 'x');
  send(good);
  for (int i = 0; i < 10; ++i) send(still);
  send(huge);
  send(other);
  good.ranges.assign(5, kNaN);  // of which none is a reading
  send(good);
  good.ranges.resize(3);
  good.message.angle_max = 0.0F;
  send(good);
  ASSERT_TRUE(next());
  const auto blind = next(), fewer = next();
  ASSERT_TRUE(blind && fewer);
  EXPECT_THAT(blind->ranges_m, testing::Each(0.0F));
  EXPECT_EQ(fewer->ranges_m.size(), 3u);
  EXPECT_THAT(robot_->report(), HasSubstr("12 were left out as unusable"));
  robot_.reset();
  const std::string told = testing::internal::GetCapturedStderr();
  const std::string domain = std::to_string(test::own_domain());
  EXPECT_THAT(told, HasSubstr("warning: rt/scan in ROS domain " + domain +
                              ": a scan of 'laser' is left out: angle_increment is 0 rad"));
  EXPECT_THAT(told, HasSubstr("a scan of 'laser\\x0A\\x1B[31mxxx"));
  EXPECT_THAT(told, HasSubstr("from here on a scan has 3 ranges, before 5"));
  EXPECT_EQ(std::count(told.begin(), told.end(), '\n'), 3) << told;  // and no more of each
}

TEST_F(RosRobot, LeavesOutOdometryThatIsNoPose) {
  testing::internal::CaptureStderr();
  open(",laser=0/0/0");
  send(test::odometry_message(100, 5.0, 0.0, 0.0));
  send(test::odometry_message(101, kNaN, 0.0, 0.0));
  ScanMessage scan;
  send(scan);
  const auto taken = next();
  ASSERT_TRUE(taken && taken->T_odom_laser);
  EXPECT_EQ(taken->T_odom_laser->x(), 5.0);
  robot_.reset();
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              HasSubstr("an odometry message (frame 'odom') is left out: its position is nan 0 0"));
}

TEST_F(RosRobot, DropsTheOldestScansWhereNobodyTakesThem) {
  testing::internal::CaptureStderr();
  open(",odom=");
  ScanMessage scan;
  const auto has_dropped = [&] {
    return testing::Matches(testing::ContainsRegex("came, [1-9][0-9]* of them"))(robot_->report());
  };
  for (; !has_dropped(); ++scan.message.header.stamp.sec) send(scan);
  std::optional<LaserScan> before = next();
  ASSERT_TRUE(before);
  EXPECT_GT(before->stamp_ns, 100'000'000'000);
  for (std::size_t i = 1; i < ScanQueue::kMost; ++i) {
    const auto scan_after = next();
    ASSERT_TRUE(scan_after);
    EXPECT_GT(scan_after->stamp_ns, before->stamp_ns);
    before = scan_after;
  }
  robot_.reset();
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("the front-end is behind"));
}

TEST_F(RosRobot, SaysThatOdometryIsMissing) {
  testing::internal::CaptureStderr();
  open(",laser=0/0/0");
  ScanMessage scan;
  send(scan);
  ASSERT_TRUE(next());
  send(test::odometry_message(3700, 5.0, 0.0, 0.0));
  dds_sleepfor(DDS_MSECS(100));
  send(scan);
  ASSERT_TRUE(next());
  EXPECT_THAT(robot_->report(), HasSubstr("2 had no odometry"));
  robot_.reset();
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("no odometry has come"));
}

TEST_F(RosRobot, LearnsWhereItsLaserSitsFromItsFixedFrames) {
  open();
  auto fixed = make_writer<ros::TFMessage>("rt/tf_static", Traffic::kFixedTransforms);
  std::string base = "base_link", laser = "laser";
  geometry_msgs_msg_dds__TransformStamped_ transform{};
  transform.header.frame_id = base.data();
  transform.child_frame_id = laser.data();
  transform.transform = {{1.0, 0.0, 0.5}, {1.0, 0.0, 0.0, 0.0}};  // upside down
  ros::TFMessage message{};
  message.transforms._buffer = &transform;
  message.transforms._length = message.transforms._maximum = 1;
  ASSERT_EQ(fixed->write(message), DDS_RETCODE_OK);
  send(test::odometry_message(100, 5.0, 0.0, 0.0));
  ScanMessage scan(3, 0.0, 0.5);
  scan.ranges = {1.0F, 2.0F, 3.0F};
  std::optional<LaserScan> taken;
  while (!taken) {  // until the transform has come, too
    send(scan);
    taken = next();
  }
  EXPECT_EQ(taken->T_odom_laser->x(), 6.0);
  EXPECT_EQ(taken->first_angle_rad, -1.0);
  EXPECT_THAT(taken->ranges_m, testing::ElementsAre(3.0F, 2.0F, 1.0F));
}

TEST_F(RosRobot, TakesItsLaserToBeInItsMiddleWhereNothingSaysOtherwise) {
  testing::internal::CaptureStderr();
  open();
  send(test::odometry_message(100, 5.0, 0.0, 0.0));
  ScanMessage scan;
  std::optional<LaserScan> taken;
  while (!taken) {
    send(scan);
    const auto next = robot_->next();
    ASSERT_TRUE(next);
    if (const auto* frame = std::get_if<SensorFrame>(&*next)) taken = std::get<LaserScan>(*frame);
  }
  EXPECT_EQ(taken->T_odom_laser->x(), 5.0);
  EXPECT_THAT(robot_->report(), HasSubstr("came before it was known where the laser sits"));
  robot_.reset();
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              HasSubstr("nothing leads from 'base_link' (odometry's child_frame_id) to 'laser'"));
}

}  // namespace
}  // namespace cairn
