// SPDX-License-Identifier: BSD-3-Clause
// A robot that comes back makes no keyframes where it was before.
#include <gtest/gtest.h>

#include "frontends/laser/laser_frontend.hpp"
#include "frontends/simulated/simulated_drive.hpp"
#include "tests/frontends/trajectories.hpp"
#include "tests/support/offline_frontend_host.hpp"

namespace cairn {
namespace {

DriveOptions two_laps() {
  DriveOptions options{.seed = 2};
  const std::vector<Eigen::Vector2d> once = options.plan.tour;
  options.plan.tour.insert(options.plan.tour.end(), once.begin() + 2, once.end());
  return options;
}

// Where people walked through the picture, or what stands there is seen from another side, a few.
TEST(KnownPlaces, NeedNoKeyframesOnASecondLap) {
  const SimulatedDrive drive = simulate_drive(two_laps());
  LaserFrontend frontend;
  test::OfflineFrontendHost host;
  const auto done = host.run(frontend, drive.scans);
  ASSERT_TRUE(done) << done.error().to_string();
  ASSERT_EQ(host.frames.size(), drive.scans.size());
  const std::uint64_t first_lap = host.frames[host.frames.size() / 2].keyframe.index;
  EXPECT_GT(first_lap, 300u);
  EXPECT_LT(host.keyframes, first_lap + 40);
  EXPECT_LT(host.frames.back().keyframe.index, first_lap) << "a place of the first lap";
  EXPECT_LT(test::aligned_rmse_m(drive.truth, host.trajectory()), 0.05);
}

// Two laps, and back the way it came: a laser that sees ahead sees for the first time what was
// behind it.
TEST(KnownPlaces, EndWhereSomethingNewIsSeen) {
  DriveOptions options{.seed = 3};
  std::vector<Eigen::Vector2d>& tour = options.plan.tour;
  const std::vector<Eigen::Vector2d> once = tour;
  tour.insert(tour.end(), once.begin() + 2, once.end());
  const std::vector<Eigen::Vector2d> back(once.rbegin() + 1, once.rend() - 2);
  tour.insert(tour.end(), back.begin(), back.end());
  const SimulatedDrive drive = simulate_drive(options);
  LaserFrontend frontend;
  test::OfflineFrontendHost host;
  const auto done = host.run(frontend, drive.scans);
  ASSERT_TRUE(done) << done.error().to_string();
  const std::size_t turn = 2 * host.frames.size() / 3;
  EXPECT_GT(host.keyframes, host.frames[turn].keyframe.index + 100);
  EXPECT_LT(test::aligned_rmse_m(drive.truth, host.trajectory()), 0.08);
}

// What finds loops in its keyframes is elsewhere, and needs them.
TEST(KnownPlaces, AreNotLookedForByATrackerAlone) {
  const SimulatedDrive drive = simulate_drive(two_laps());
  LaserFrontend frontend;
  test::OfflineFrontendHost host;
  host.asked.loop_closer = false;
  const auto done = host.run(frontend, drive.scans);
  ASSERT_TRUE(done) << done.error().to_string();
  EXPECT_EQ(host.loops, 0u);
  EXPECT_GT(host.keyframes, host.frames[host.frames.size() / 2].keyframe.index + 300);
}

}  // namespace
}  // namespace cairn
