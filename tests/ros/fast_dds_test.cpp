// SPDX-License-Identifier: BSD-3-Clause
// Daemon and front-end as processes against a robot on Fast DDS, which knows our types from its own
// copy of them only.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <sstream>

#include "frontends/simulated/simulated_drive.hpp"
#include "tests/ros/mount.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/process.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

using test::Process;
using test::ProcessResult;
using testing::HasSubstr;

#ifdef FAST_DDS_ROBOT_BINARY
constexpr const char* kFastDdsRobot = FAST_DDS_ROBOT_BINARY;
#else
constexpr const char* kFastDdsRobot = nullptr;
#endif

constexpr std::size_t kScans = 300;
constexpr double kFirstStampS = 1'700'000'000.0;

// A line that the robot has printed: "path map 12 STAMP X Y YAW", "tf map odom STAMP X Y YAW".
struct Told {
  std::size_t count = 0;
  std::string frame, detail;
  double stamp_s = 0.0;
  Se2 pose;
};

Told last_told(const std::string& text, const std::string& word) {
  Told told;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream in(line);
    std::string first;
    if (!(in >> first) || first != word) continue;
    ++told.count;
    double x = 0.0, y = 0.0, yaw = 0.0;
    EXPECT_TRUE(in >> told.frame >> told.detail >> told.stamp_s >> x >> y >> yaw) << line;
    told.pose = Se2(x, y, yaw);
  }
  return told;
}

// Where the laser was, by truth, seen from where it began.
Se2 truth_at(const SimulatedDrive& drive, double stamp_s) {
  std::size_t best = 0;
  for (std::size_t i = 0; i < kScans; ++i) {
    const auto off = [&](std::size_t k) {
      return std::abs(kFirstStampS + 1e-9 * static_cast<double>(drive.scans[k].stamp_ns) - stamp_s);
    };
    if (off(i) < off(best)) best = i;
  }
  return drive.truth[0].inverse() * drive.truth[best];
}

const Se2& odometry_at(const SimulatedDrive& drive, double stamp_s) {
  const auto i = static_cast<std::size_t>(std::lround((stamp_s - kFirstStampS) / 0.1));
  return *drive.scans.at(i).T_odom_laser;
}

// The rest of the last line that begins with this word.
std::string last_grid(const std::string& text, const std::string& word) {
  std::string found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(word + " ")) found = line.substr(word.size() + 1);
  return found;
}

double number_after(const std::string& text, const std::string& word) {
  const std::size_t at = text.find(word);
  return at == std::string::npos ? -1.0 : std::atof(text.c_str() + at + word.size());
}

void expect_near(const Se2& found, const Se2& expected, const char* what) {
  const Se2 off = expected.inverse() * found;
  EXPECT_LT(off.translation().norm(), 0.1) << what;
  EXPECT_LT(std::abs(off.theta()), 0.02) << what;
}

TEST(FastDds, ARobotIsMappedAndLearnsWhereItIs) {
  if (kFastDdsRobot == nullptr)
    GTEST_SKIP() << "Fast DDS is not installed (Debian: libfastrtps-dev)";
  const test::TemporaryFolder folder;
  const std::string domain = std::to_string(test::own_domain());
  const std::string config =
      folder.write("cairnd.yaml", "ros:\n  map: /map\n  domain: " + domain + "\n");
  Process daemon(
      {CAIRND_BINARY, "--data", folder.file("data"), "--domain", domain, "--config", config});
  Process frontend({FRONTEND_BINARY, "laser", "--input", "ros:domain=" + domain, "--robot",
                    "kestrel", "--spool", folder.file("spool"), "--domain", domain, "--settle"});
  // 8 s after the drive: a map with all changes in it is sent every 5.
  const ProcessResult robot =
      Process({kFastDdsRobot, domain, std::to_string(kScans), "50", "8"}).wait();
  ASSERT_EQ(robot.exit_code, 0) << robot.err << frontend.end(SIGINT).err;
  const ProcessResult mapped = frontend.end(SIGINT);
  EXPECT_EQ(mapped.exit_code, 0) << mapped.err;
  EXPECT_THAT(mapped.err, HasSubstr("0 were left out as unusable; 0 had no odometry"));
  EXPECT_THAT(mapped.out, HasSubstr("settled at "));

  const SimulatedDrive drive = simulate_drive();
  const Told path = last_told(robot.out, "path");
  ASSERT_GT(path.count, 0u) << robot.out;
  EXPECT_EQ(path.frame, "map");
  EXPECT_GT(std::stoi(path.detail), 50);  // poses
  EXPECT_GT(path.stamp_s, kFirstStampS + 25.0);
  EXPECT_THAT(mapped.out, HasSubstr(" frames, " + path.detail + " keyframes "));
  expect_near(path.pose * test::T_base_laser(), truth_at(drive, path.stamp_s), "path");

  const Told tf = last_told(robot.out, "tf");
  ASSERT_GT(tf.count, kScans / 2) << robot.out;
  EXPECT_EQ(tf.frame, "map");
  EXPECT_EQ(tf.detail, "odom");
  const double scan_s = tf.stamp_s - 0.2;
  EXPECT_GT(scan_s, kFirstStampS + 29.0);
  expect_near(tf.pose * odometry_at(drive, scan_s), truth_at(drive, scan_s), "tf");
  // What was patched is what was sent whole at last, and both are a map.
  const std::string map = last_grid(robot.out, "map");
  EXPECT_EQ(map, last_grid(robot.out, "patched"));
  EXPECT_THAT(robot.out, testing::ContainsRegex("grids [1-9].* patches [1-9]"));
  EXPECT_THAT(map, testing::ContainsRegex("^map [0-9]+ [0-9]+ 0.05 .* odd 0 of [0-9]+$"));
  const double free = number_after(map, " free "), occupied = number_after(map, " occupied ");
  EXPECT_GT(occupied, 1000);
  EXPECT_GT(free, 10 * occupied);
  EXPECT_GT(number_after(map, " unknown "), 0);
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait().exit_code, 0);
}

}  // namespace
}  // namespace cairn
