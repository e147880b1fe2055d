// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/carmen/carmen_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "cairn/io/compression.hpp"
#include "tests/support/datasets.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kDegree = std::numbers::pi / 180.0;

std::string readings(std::size_t count, const std::string& reading = "1.5") {
  std::string text = std::to_string(count);
  for (std::size_t i = 0; i < count; ++i) text += " " + reading;
  return text;
}

const std::string kPoses = " 1 2 0.5 1 2 0.5 ";

std::string flaser(std::size_t count, const std::string& poses = kPoses,
                   const std::string& stamp = "10.25") {
  return "FLASER " + readings(count) + poses + stamp + " host 0.5\n";
}

std::string robotlaser(const std::string& values, const std::string& poses = kPoses) {
  return "ROBOTLASER1 0 -1.5 3.14 0.01 50 0.1 0 " + values + " 0" + poses +
         "0.1 0 0 0 0 7.125 host 0.5\n";
}

CarmenLog read(const std::string& text, const CarmenOptions& options = {}) {
  Result<CarmenLog> log = read_carmen_text(text, "f", options);
  EXPECT_TRUE(log) << log.error().to_string();
  return log ? std::move(*log) : CarmenLog{};
}

TEST(CarmenLog, FlaserBeamsAreHalfACircle) {
  struct Geometry {
    std::size_t count;
    double step_deg;
  };
  for (const auto& [count, step_deg] : {Geometry{180, 1.0}, {181, 1.0}, {360, 0.5}, {361, 0.5}}) {
    const CarmenLog log = read(flaser(count));
    ASSERT_THAT(log.scans, SizeIs(1));
    const LaserScan& scan = log.scans[0];
    EXPECT_DOUBLE_EQ(scan.first_angle_rad, -90.0 * kDegree) << count;
    EXPECT_DOUBLE_EQ(scan.angle_step_rad, step_deg * kDegree) << count;
    EXPECT_EQ(scan.max_range_m, 80.0);
    EXPECT_EQ(scan.ranges_m, std::vector<float>(count, 1.5F));
    EXPECT_EQ(scan.stamp_ns, 10250000000);
    ASSERT_TRUE(scan.T_odom_laser);
    EXPECT_EQ(scan.T_odom_laser->to_vector(), Eigen::Vector3d(1.0, 2.0, 0.5));
    EXPECT_THAT(log.warnings, IsEmpty());
  }
}

TEST(CarmenLog, ParametersTellTheLargestRangeAndOtherAngles) {
  const CarmenLog log = read(
      "PARAM robot_front_laser_max 50.0 nohost 0\nPARAM laser_front_laser_resolution 0.5 x 0\n" +
      flaser(541));
  EXPECT_EQ(log.scans[0].max_range_m, 50.0);
  EXPECT_DOUBLE_EQ(log.scans[0].angle_step_rad, 0.5 * kDegree);
  EXPECT_DOUBLE_EQ(log.scans[0].first_angle_rad, -135.0 * kDegree);
  const CarmenLog told = read(flaser(91), {.field_of_view_rad = 270.0 * kDegree});
  EXPECT_DOUBLE_EQ(told.scans[0].angle_step_rad, 3.0 * kDegree);
  EXPECT_DOUBLE_EQ(told.scans[0].first_angle_rad, -135.0 * kDegree);
}

TEST(CarmenLog, RobotLaserLinesSayAllThemselves) {
  const CarmenLog log = read("# comment\r\n\r\nSYNC x 1 h 2\r\n" + robotlaser("2 1.25 49.5"));
  ASSERT_THAT(log.scans, SizeIs(1));
  const LaserScan& scan = log.scans[0];
  EXPECT_EQ(scan.first_angle_rad, -1.5);
  EXPECT_EQ(scan.angle_step_rad, 0.01);
  EXPECT_EQ(scan.max_range_m, 50.0);
  EXPECT_THAT(scan.ranges_m, ElementsAre(1.25F, 49.5F));
  EXPECT_EQ(scan.stamp_ns, 7125000000);
}

TEST(CarmenLog, StampsAreExactMayRepeatAndGoBack) {
  const CarmenLog log = read(flaser(180, kPoses, "976052857.337530") + flaser(180, kPoses, "5") +
                             flaser(180, kPoses, "5"));
  ASSERT_THAT(log.scans, SizeIs(3));
  EXPECT_EQ(log.scans[0].stamp_ns, 976052857337530000);
  EXPECT_EQ(log.scans[1].stamp_ns, 5000000000);
  EXPECT_EQ(log.scans[2].stamp_ns, 5000000000);
  EXPECT_THAT(log.warnings, IsEmpty());
}

TEST(CarmenLog, TheLoggersStampMayBeAbsent) {
  EXPECT_THAT(read("FLASER " + readings(180) + kPoses + "10.25 host\n").scans, SizeIs(1));
}

TEST(CarmenLog, ALastLineThatWasCutIsLeftOut) {
  const std::string whole = flaser(180), line = flaser(180);
  // Wherever the second line ends: in its tag it is no line, in its stamp it must not be believed.
  for (std::size_t length = 0; length + 1 < line.size(); ++length) {
    const auto log = read_carmen_text(whole + line.substr(0, length), "f");
    ASSERT_TRUE(log) << length << log.error().to_string();
    const bool complete = length >= line.find("host") + 1;
    ASSERT_THAT(log->scans, SizeIs(complete ? 2 : 1)) << length;
    ASSERT_THAT(log->warnings, SizeIs(complete || length < 6 ? 0 : 1)) << length;
  }
  const CarmenLog cut = read(whole + "FLASER 180 1.0 2.0");
  EXPECT_THAT(
      cut.warnings,
      ElementsAre("f:2:1: FLASER with 180 readings expects 190 fields, found 3; the log was "
                  "cut in this FLASER line, which is left out"));
}

TEST(CarmenLog, ReadingsThatAreNoEchoAreKeptAndTold) {
  const CarmenLog log = read(robotlaser("6 nan inf -1 1e300 81.91 2.5"));
  const std::vector<float>& ranges = log.scans[0].ranges_m;
  EXPECT_TRUE(std::isnan(ranges[0]));
  EXPECT_EQ(ranges[1], std::numeric_limits<float>::infinity());
  EXPECT_EQ(ranges[2], -1.0F);
  EXPECT_EQ(ranges[3], std::numeric_limits<float>::infinity());
  EXPECT_EQ(ranges[4], 81.91F);
  EXPECT_EQ(ranges[5], 2.5F);
  EXPECT_THAT(log.warnings,
              ElementsAre("f:1:41: 2 readings are negative or no number, the first in this line; "
                          "they are taken as no echo"));
}

TEST(CarmenLog, ChangesOfTheNumberOfReadingsAreTold) {
  const CarmenLog log = read(flaser(180) + flaser(361) + flaser(361));
  EXPECT_THAT(log.scans, SizeIs(3));
  EXPECT_DOUBLE_EQ(log.scans[2].angle_step_rad, 0.5 * kDegree);
  EXPECT_THAT(log.warnings,
              ElementsAre("f:2:12: from here on a scan has 361 readings, before 180"));
  std::string many;
  for (int i = 0; i < 10; ++i) many += flaser(i % 2 ? 180 : 181);
  EXPECT_THAT(read(many).warnings, SizeIs(6));
}

TEST(CarmenLog, OdometryThatIsAbsentComesFromOdomLines) {
  const std::string nowhere = " 0 0 0 0 0 0 ";
  const CarmenLog none = read(flaser(180, nowhere) + flaser(180, nowhere));
  EXPECT_FALSE(none.scans[0].T_odom_laser);
  EXPECT_FALSE(none.scans[1].T_odom_laser);
  EXPECT_THAT(none.warnings, ElementsAre("f:1:12: the log has no odometry: all its poses are 0"));

  const CarmenLog odom = read("PARAM robot_frontlaser_offset 0.25 x 0\n" + flaser(180, nowhere) +
                              "ODOM 1 2 0 0 0 0 1 h 1\n" + flaser(180, nowhere) +
                              "ODOM 3 2 nan 0 0 0 1 h 1\n" + flaser(180, nowhere));
  EXPECT_FALSE(odom.scans[0].T_odom_laser);
  ASSERT_TRUE(odom.scans[1].T_odom_laser);
  EXPECT_EQ(odom.scans[1].T_odom_laser->to_vector(), Eigen::Vector3d(1.25, 2.0, 0.0));
  EXPECT_FALSE(odom.scans[2].T_odom_laser);
}

TEST(CarmenLog, OdometryThatIsNotFiniteIsLeftOut) {
  const CarmenLog log = read(flaser(180) + flaser(180, " 1 nan 0 1 2 0 ") + flaser(180));
  EXPECT_FALSE(log.scans[1].T_odom_laser);
  EXPECT_TRUE(log.scans[2].T_odom_laser);
  EXPECT_THAT(log.warnings, ElementsAre(HasSubstr("f:2:12: 1 scans have an odometry that is not "
                                                  "finite, the first in this line")));
}

TEST(CarmenLog, CorrectedPosesAreNotOdometry) {
  const CarmenLog log = read("PARAM robot_frontlaser_offset 0.1 x 0\n" +
                             flaser(180, " 0.1 0 0 0 0 0 ") + flaser(180, " 1.5 0.2 0 1 0 0 "));
  ASSERT_TRUE(log.scans[1].T_odom_laser);
  EXPECT_EQ(log.scans[1].T_odom_laser->to_vector(), Eigen::Vector3d(1.1, 0.0, 0.0));
  EXPECT_THAT(log.warnings, ElementsAre(HasSubstr("another program has corrected them")));
  // A laser that is mounted somewhere and stays there is none.
  const CarmenLog mounted = read(flaser(180, " 0.1 0 0 0 0 0 ") + flaser(180, " 1.1 0 0 1 0 0 "));
  EXPECT_THAT(mounted.warnings, IsEmpty());
}

TEST(CarmenLog, OneKindOfScanIsTaken) {
  const std::string raw = "RAWLASER1 0 -1.5 3.14 0.01 50 0.1 0 1 9.5 0 3.5 h 0\n";
  const CarmenLog both = read(raw + flaser(180) + robotlaser("1 2.5"));
  ASSERT_THAT(both.scans, SizeIs(1));
  EXPECT_THAT(both.scans[0].ranges_m, ElementsAre(2.5F));
  EXPECT_THAT(both.warnings, SizeIs(2));
  const CarmenLog alone = read("ODOM 1 2 0.5 0 0 0 1 h 1\n" + raw);
  EXPECT_THAT(alone.scans[0].ranges_m, ElementsAre(9.5F));
  EXPECT_EQ(alone.scans[0].T_odom_laser->to_vector(), Eigen::Vector3d(1.0, 2.0, 0.5));
}

struct Case {
  std::string text, message;
};
class MalformedCarmen : public testing::TestWithParam<Case> {};
TEST_P(MalformedCarmen, GetsOneExactMessage) {
  const auto log = read_carmen_text(GetParam().text, "f");
  EXPECT_EQ(log ? "accepted" : log.error().to_string(), GetParam().message);
}

const std::string kNoScan =
    "f:1:1: no laser scan in it; ROBOTLASER1, FLASER or RAWLASER1 lines of a CARMEN log are "
    "expected";
const std::string kCount = " is no number of readings: a whole number from 2 to 100000 is expected";
INSTANTIATE_TEST_SUITE_P(
    Texts, MalformedCarmen,
    testing::Values(
        Case{"", kNoScan}, Case{"# FLASER 180\nODOM 1 2 3 0 0 0 1 h 1\n", kNoScan},
        Case{std::string("\x7F\x45LF\x00\x01\n", 7), kNoScan}, Case{"FLASER 180 1 2", kNoScan},
        Case{"FLASER\n" + flaser(180), "f:1:7: the line ends; expected number of readings"},
        Case{"FLASER -5 1\n", "f:1:8: '-5'" + kCount}, Case{"FLASER 1 1\n", "f:1:8: '1'" + kCount},
        Case{"FLASER 1e9 1\n", "f:1:8: '1e9'" + kCount},
        Case{"FLASER 99999999999999999999 1\n", "f:1:8: '99999999999999999999'" + kCount},
        Case{"FLASER 180 1 2 3\n" + flaser(180),
             "f:1:1: FLASER with 180 readings expects 190 fields, found 4"},
        Case{"FLASER " + readings(180, "1.5m") + kPoses + "1 h 1\n",
             "f:1:12: '1.5m' is not a number; expected a reading"},
        Case{"FLASER " + readings(180, "1") + " x 2 0 1 2 0 1 h 1\n",
             "f:1:372: 'x' is not a number; expected the laser's pose"},
        Case{flaser(180, kPoses, "yesterday"), "f:1:748: 'yesterday' is not a number"},
        Case{flaser(180, kPoses, "-1"),
             "f:1:748: '-1' is not a time stamp: seconds from 0 to 9e9 are expected"},
        Case{flaser(90),
             "f:1:11: FLASER with 90 readings does not tell its angles: 180, 181, 360 or 361 are "
             "half a circle; for others give the field of view, or a line 'PARAM "
             "laser_front_laser_resolution DEGREES'"},
        Case{"ODOM 1 2\n" + flaser(180), "f:1:9: the line ends; expected the robot's pose"},
        Case{"ODOM 1 b 3\n" + flaser(180), "f:1:8: 'b' is not a number; expected the robot's pose"},
        Case{"ROBOTLASER1 0 -9 3 0.01 50 0 0 1 1\n",
             "f:1:15: the first angle must be within a turn, in rad"},
        Case{"ROBOTLASER1 0 -1 3 0 50 0 0 1 1\n", "f:1:20: the angular resolution must be above 0"},
        Case{"ROBOTLASER1 0 -1 3 0.1 0 0 0 1 1\n", "f:1:24: the largest range must be above 0"},
        Case{"ROBOTLASER1 0 -1 3 0.1 nan 0 0 1 1\n",
             "f:1:24: 'nan' is not a finite number; expected the largest range"},
        Case{"ROBOTLASER1 0 -1 3 0.1 50 0 0 90 1\n",
             "f:1:31: so many readings at this angular resolution are more than a turn"},
        Case{"ROBOTLASER1 0 -1 3 0.1 50 0 0 2 1.5\n", "f:1:36: the line ends; expected a reading"},
        Case{robotlaser("2 1.5 2.5 x"),
             "f:1:49: 'x' is no number of remissions: a whole number from 0 to 100000 is expected"},
        Case{robotlaser("2 1.5"),
             "f:1:1: ROBOTLASER1 with 2 readings expects 26 fields, found 24"}));

TEST(CarmenLog, OfACutArchiveIsRefused) {
  test::TemporaryFolder folder;
  const std::string packed = compress(flaser(180) + flaser(361), Compression::kBzip2);
  const std::string path = folder.write("log.clf.bz2", packed.substr(0, packed.size() / 2));
  const auto log = read_carmen_log(path);
  ASSERT_FALSE(log);
  EXPECT_EQ(log.error().code, ErrorCode::kBadInput);
  EXPECT_THAT(log.error().to_string(), HasSubstr("log.clf.bz2"));
  EXPECT_FALSE(read_carmen_log(folder.file("absent.clf")));
  const std::string sound = folder.write("sound.clf.bz2", packed);
  EXPECT_TRUE(read_carmen_log(sound));
}

TEST(CarmenLog, IntelIsReadWhole) {
  CAIRN_REQUIRE_DATASET(intel, "laser/intel.clf.bz2");
  const auto log = read_carmen_log(intel);
  ASSERT_TRUE(log) << log.error().to_string();
  EXPECT_THAT(log->warnings, IsEmpty());
  ASSERT_THAT(log->scans, SizeIs(13631));
  EXPECT_EQ(log->scans[0].stamp_ns, 976052857337530000);
  int backwards = 0;
  for (std::size_t i = 1; i < log->scans.size(); ++i) {
    backwards += log->scans[i].stamp_ns < log->scans[i - 1].stamp_ns;
    ASSERT_THAT(log->scans[i].ranges_m, SizeIs(180));
    ASSERT_TRUE(log->scans[i].T_odom_laser);
  }
  EXPECT_EQ(backwards, 631);
}

TEST(CarmenLog, CsailIsReadWholeAndItsGraphLogToo) {
  CAIRN_REQUIRE_DATASET(csail, "laser/mit-csail.clf.bz2");
  const auto log = read_carmen_log(csail);
  ASSERT_TRUE(log) << log.error().to_string();
  EXPECT_THAT(log->warnings, IsEmpty());
  EXPECT_THAT(log->scans, SizeIs(1988));
  CAIRN_REQUIRE_DATASET(graph, "laser/flirt_mit-csail.log");
  const auto scans = read_carmen_log(graph);
  ASSERT_TRUE(scans) << scans.error().to_string();
  EXPECT_THAT(scans->scans, SizeIs(1051));
  EXPECT_EQ(scans->scans[0].max_range_m, 50.0);
}

}  // namespace
}  // namespace cairn
