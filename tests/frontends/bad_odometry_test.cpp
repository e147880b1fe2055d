// SPDX-License-Identifier: BSD-3-Clause
// Wheels whose counts come late, or jump: scans say where the robot is all the same.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "frontends/laser/laser_tracker.hpp"
#include "frontends/simulated/simulated_drive.hpp"
#include "tests/frontends/trajectories.hpp"

namespace cairn {
namespace {

// How far the tracker alone, without loops, is off over the first 600 scans of a drive whose
// odometry is spoiled.
double tracker_rmse_m(const std::function<void(std::vector<LaserScan>&)>& spoil) {
  SimulatedDrive drive = simulate_drive({.seed = 3});
  drive.scans.resize(600);
  spoil(drive.scans);
  LaserTracker tracker;
  std::vector<Se2> found;
  for (const LaserScan& scan : drive.scans) found.push_back(tracker.track(scan).T_odom_laser);
  return test::aligned_rmse_m(drive.truth, found);
}

TEST(BadOdometry, ThatStopsAndCatchesUpDoesNotBendTheWay) {
  const double undisturbed_m = tracker_rmse_m([](auto&) {});
  const double late_m = tracker_rmse_m([](std::vector<LaserScan>& scans) {
    for (std::size_t i = 40; i < scans.size(); ++i)
      if (i % 20 < 5) scans[i].T_odom_laser = scans[i - 1].T_odom_laser;
  });
  EXPECT_LT(late_m, 1.5 * undisturbed_m + 0.01) << undisturbed_m;
}

TEST(BadOdometry, ThatJumpsDoesNotBendTheWay) {
  const double undisturbed_m = tracker_rmse_m([](auto&) {});
  for (const Se2& jump : {Se2(0.0, 0.0, 1.5), Se2(2.0, -1.0, 0.0), Se2(-1.0, 5.0, 3.0)}) {
    const double jumped_m = tracker_rmse_m([&](std::vector<LaserScan>& scans) {
      for (std::size_t from = 50; from < scans.size(); from += 100)
        for (std::size_t i = from; i < scans.size(); ++i)
          scans[i].T_odom_laser = jump * *scans[i].T_odom_laser;
    });
    EXPECT_LT(jumped_m, 1.5 * undisturbed_m + 0.01) << undisturbed_m;
  }
}

// Nothing but wheels says there that the robot does not drive on.
TEST(BadOdometry, OfARobotThatStopsInABareCorridorIsBelieved) {
  const SimulatedDrive drive = simulate_drive({.seed = 3});
  std::size_t at = 0;
  while (drive.truth[at].y() < 20.0 || std::abs(drive.truth[at].x() - 17.0) > 1.0) ++at;
  LaserTracker tracker;
  for (std::size_t i = 0; i <= at; ++i) tracker.track(drive.scans[i]);
  const Se2 stop = tracker.track(drive.scans[at]).T_odom_laser;
  Se2 later;
  for (int i = 0; i < 200; ++i) later = tracker.track(drive.scans[at]).T_odom_laser;
  EXPECT_LT((stop.inverse() * later).translation().norm(), 0.02);
}

}  // namespace
}  // namespace cairn
