// SPDX-License-Identifier: BSD-3-Clause
// Robots without wheels: the laser front-end alone knows how they move.
#include <gtest/gtest.h>

#include <cmath>

#include "cairn/evaluation/relations.hpp"
#include "cairn/evaluation/statistics.hpp"
#include "frontends/carmen/carmen_log.hpp"
#include "frontends/laser/laser_frontend.hpp"
#include "frontends/simulated/simulated_drive.hpp"
#include "tests/frontends/trajectories.hpp"
#include "tests/support/datasets.hpp"
#include "tests/support/offline_frontend_host.hpp"

namespace cairn {
namespace {

std::vector<LaserScan> without_odometry(std::vector<LaserScan> scans) {
  for (LaserScan& scan : scans) scan.T_odom_laser.reset();
  return scans;
}

TEST(WithoutOdometry, MapsASimulatedBuilding) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    SCOPED_TRACE(seed);
    const SimulatedDrive drive = simulate_drive({.seed = seed});
    LaserFrontend frontend;
    test::OfflineFrontendHost host;
    const auto done = host.run(frontend, without_odometry(drive.scans));
    ASSERT_TRUE(done) << done.error().to_string();
    ASSERT_EQ(host.frames.size(), drive.scans.size());
    EXPECT_GT(host.loops, 0u);
    const double rmse_m = test::aligned_rmse_m(drive.truth, host.trajectory());
    testing::Test::RecordProperty("rmse_m", std::to_string(rmse_m));
    EXPECT_LT(rmse_m, 0.03);
    ASSERT_FALSE(host.told.empty());
    EXPECT_EQ(host.told.front(),
              "the scan stamped 0 ns comes without odometry: its motion is guessed from the one "
              "before, and so for all like it");
  }
}

// Published scan matching without odometry or loops: 0.220 m.
TEST(WithoutOdometry, MapsIntel) {
  const auto log = test::dataset("laser/intel.clf.bz2");
  const auto truth = test::dataset("laser/intel.relations");
  if (!log || !truth) GTEST_SKIP() << "data set absent";
  const auto carmen = read_carmen_log(log->string());
  ASSERT_TRUE(carmen) << carmen.error().to_string();
  LaserFrontend frontend;
  test::OfflineFrontendHost host;
  const auto done = host.run(frontend, without_odometry(carmen->scans));
  ASSERT_TRUE(done) << done.error().to_string();
  const auto relations = read_relations(truth->string());
  ASSERT_TRUE(relations) << relations.error().to_string();
  const auto errors = relation_errors(*relations, test::as_trajectory(host));
  ASSERT_TRUE(errors) << errors.error().to_string();
  EXPECT_TRUE(errors->unmatched.empty());
  const double mean_m = compute_statistics(errors->errors.translation_m).mean;
  const double mean_deg = compute_statistics(errors->errors.rotation_deg).mean;
  testing::Test::RecordProperty("mean_m", std::to_string(mean_m));
  testing::Test::RecordProperty("mean_deg", std::to_string(mean_deg));
  EXPECT_LT(mean_m, 0.03);
  EXPECT_LT(mean_deg, 0.35);
}

PointToLineMatch seen(int free) {
  PointToLineMatch match;
  match.free = free;
  if (free > 0) match.free_direction = Eigen::Vector3d(0.0, 1.0, 0.0);
  return match;
}

TEST(BlindStretch, IsToldOfWhereItBeginsAndEnds) {
  BlindStretch watch;
  EXPECT_EQ(watch.summary(), "");
  std::vector<std::string> told;
  const auto take = [&](int free, std::size_t scans, std::size_t keyframe) {
    for (std::size_t i = 0; i < scans; ++i)
      if (const auto news = watch.take(seen(free), keyframe)) told.push_back(*news);
  };
  take(0, 30, 1);
  take(1, 9, 2);  // too few
  take(0, 1, 3);
  EXPECT_TRUE(told.empty());
  take(1, 20, 4);
  take(0, 3, 5);
  take(1, 3, 6);
  take(0, 30, 7);
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0],
            "at keyframe 4 scans begin to leave shifts along 90 deg to the left of ahead free: "
            "only the predicted motion holds the map there");
  EXPECT_EQ(told[1], "at keyframe 7 surfaces show every direction again, after 26 scans");
  EXPECT_EQ(watch.summary(),
            "32 of 96 scans left a direction free, in 1 stretch of 10 scans and more");
}

}  // namespace
}  // namespace cairn
