// SPDX-License-Identifier: BSD-3-Clause
// The front-end's process against the daemon's, over real DDS.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <sstream>

#include "frontends/host/frame_source.hpp"
#include "frontends/host/plugins.hpp"
#include "frontends/simulated/simulated_drive.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/process.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

using test::Process;
using test::ProcessResult;
using testing::HasSubstr;

ProcessResult run_frontend(std::vector<std::string> words) {
  words.insert(words.begin(), FRONTEND_BINARY);
  return Process(words).wait();
}

std::size_t count_lines(const std::string& path) {
  std::ifstream in(path);
  std::size_t lines = 0;
  for (std::string line; std::getline(in, line);) lines += !line.empty() && line[0] != '#';
  return lines;
}

TEST(FrontendProcess, MapsASimulatedBuildingAndGoesOnWhereItsSpoolEnds) {
  const test::TemporaryFolder folder;
  const std::string domain = std::to_string(test::own_domain());
  Process daemon({CAIRND_BINARY, "--data", folder.file("data"), "--domain", domain});
  const std::vector<std::string> words{
      "laser",   "--input",  "simulated",          "--robot",
      "kestrel", "--spool",  folder.file("spool"), "--domain",
      domain,    "--settle", "--trajectory",       folder.file("kestrel.tum")};
  const ProcessResult first = run_frontend(words);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("1691 frames, "));
  EXPECT_THAT(first.out, HasSubstr("settled at "));
  EXPECT_EQ(count_lines(folder.file("kestrel.tum")), 1691u);
  const ProcessResult status = Process({CAIRN_BINARY, "status", "--domain", domain}).wait();
  EXPECT_THAT(status.out, HasSubstr("kestrel-tracker"));
  EXPECT_THAT(status.out, HasSubstr("kestrel-loops"));
  // Everything was sent: the same run again adds no keyframe.
  const ProcessResult again = run_frontend(words);
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("1691 frames, 0 keyframes "));
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait().exit_code, 0);
}

TEST(FrontendProcess, GivesTheSameBitsInLockstep) {
  std::vector<std::string> found;
  for (const char* run : {"one", "two"}) {
    const test::TemporaryFolder folder;
    const std::string domain = std::to_string(test::own_domain());
    Process daemon({CAIRND_BINARY, "--data", folder.file("data"), "--domain", domain});
    const ProcessResult result = run_frontend(
        {"laser", "--input", "simulated", "--robot", "kestrel", "--spool", folder.file("spool"),
         "--domain", domain, "--lockstep", "--trajectory", folder.file("kestrel.tum")});
    ASSERT_EQ(result.exit_code, 0) << run << result.err;
    std::ifstream in(folder.file("kestrel.tum"));
    found.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    daemon.send(SIGTERM);
    EXPECT_EQ(daemon.wait().exit_code, 0);
  }
  EXPECT_GT(found[0].size(), 100'000u);
  EXPECT_TRUE(found[0] == found[1]);
}

// Half a minute of a drive, as a log.
std::string drive_as_log(double first_stamp_s) {
  const SimulatedDrive drive = simulate_drive();
  std::ostringstream log;
  for (std::size_t i = 0; i < 300; ++i) {
    const LaserScan& scan = drive.scans[i];
    log << "FLASER " << scan.ranges_m.size();
    for (const float range : scan.ranges_m) log << ' ' << range;
    const Se2& T = *scan.T_odom_laser;
    for (int repeat = 0; repeat < 2; ++repeat)
      log << ' ' << T.x() << ' ' << T.y() << ' ' << T.theta();
    const double stamp_s = first_stamp_s + 1e-9 * static_cast<double>(scan.stamp_ns);
    log << ' ' << stamp_s << " host " << stamp_s << '\n';
  }
  return log.str();
}

TEST(FrontendProcess, BeginsAnewWhereTheClockOfALogGoesBack) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.file("twice.clf")) << drive_as_log(1000.0) << drive_as_log(990.0);
  const std::string domain = std::to_string(test::own_domain());
  Process daemon({CAIRND_BINARY, "--data", folder.file("data"), "--domain", domain});
  const std::vector<std::string> words{
      "laser",   "--input",  folder.file("twice.clf"), "--robot",
      "kestrel", "--spool",  folder.file("spool"),     "--domain",
      domain,    "--settle", "--trajectory",           folder.file("t.tum")};
  const ProcessResult first = run_frontend(words);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.err, HasSubstr("kestrel: frame 301 is 39.9 s behind the newest: a new epoch"));
  EXPECT_THAT(first.err, HasSubstr("2 maps that nothing ties together"));
  EXPECT_THAT(first.out, HasSubstr("600 frames in 2 epochs, "));
  EXPECT_EQ(count_lines(folder.file("t.tum")), 600u);
  // Both halves are the same drive: they have as many keyframes each, and none is made twice.
  const ProcessResult again = run_frontend(words);
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("600 frames in 2 epochs, 0 keyframes "));
  EXPECT_EQ(count_lines(folder.file("t.tum")), 600u);
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait().exit_code, 0);
}

TEST(FrontendProcess, SaysWhatItCannotDo) {
  const test::TemporaryFolder folder;
  const auto expect = [&](std::vector<std::string> words, int code, const std::string& message) {
    words.insert(words.end(), {"--robot", "r", "--spool", folder.file("spool")});
    const ProcessResult result = run_frontend(words);
    EXPECT_EQ(result.exit_code, code);
    EXPECT_THAT(result.err, HasSubstr(message));
  };
  expect({"sonar", "--input", "simulated"}, 2,
         "unknown front-end 'sonar'; expected laser, or the path of a shared object");
  expect({"./nothing.so", "--input", "simulated"}, 2, "cannot be loaded: ");
  expect({"laser", "--input", "ros:speed=3"}, 2, "'speed=3' is no setting");
  expect({"laser", "--input", "ros:interface=lo", "--domain", "0"}, 2, "is also the daemon's");
  expect({"laser", "--input", "ros:domain=229", "--rate", "5"}, 2, "a live robot sets the pace");
  expect({"laser", "--input", "simulated:x"}, 2,
         "the seed 'x' of the simulation is no whole number");
  expect({"laser", "--input", "/no/such/log"}, 3, "/no/such/log");
  expect({"laser", "--input", "simulated", "--rate", "-1"}, 2, "--rate");
  expect({"laser", "--input", "simulated", "--trajectory", "/no/such/folder/t.tum"}, 2,
         "/no/such/folder");
  std::ofstream(folder.file("empty.clf")) << "# nothing\n";
  expect({"laser", "--input", folder.file("empty.clf")}, 3, "empty.clf");
}

}  // namespace
}  // namespace cairn
