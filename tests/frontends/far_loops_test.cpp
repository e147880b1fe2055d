// SPDX-License-Identifier: BSD-3-Clause
// Loops where poses are far off: how far that may be, what agrees, and a building with a long bare
// corridor in which wheels alone know how far the robot went.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include "datasets/random.hpp"
#include "frontends/laser/drift_bound.hpp"
#include "frontends/laser/laser_frontend.hpp"
#include "frontends/laser/loop_stories.hpp"
#include "frontends/simulated/simulated_drive.hpp"
#include "tests/frontends/trajectories.hpp"

namespace cairn {
namespace {

Eigen::Matrix3d random_covariance(Random& random) {
  Eigen::Matrix3d A;
  for (int i = 0; i < 9; ++i) A(i / 3, i % 3) = 0.02 * random.normal();
  return A * A.transpose();
}

double worst_sigma(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(covariance.topLeftCorner<2, 2>());
  return std::sqrt(solver.eigenvalues()[1]);
}

struct Step {
  Se2 T;
  Eigen::Matrix3d covariance;
};

std::vector<Step> random_steps(std::size_t count, std::uint64_t seed) {
  Random random(seed, 0);
  std::vector<Step> steps;
  for (std::size_t i = 0; i < count; ++i)
    steps.push_back(
        {Se2(1.0 + random.normal(), random.normal(), random.normal()), random_covariance(random)});
  return steps;
}

DriftBound chain_of(const std::vector<Step>& steps) {
  DriftBound drift;
  drift.add_keyframe(Se2(), Eigen::Matrix3d::Zero());
  for (const Step& step : steps) drift.add_keyframe(step.T, step.covariance);
  return drift;
}

// Of the last pose seen from the first: every step's error, carried to the end.
Eigen::Matrix3d composed(const std::vector<Step>& steps) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  Se2 T_here_end;
  for (std::size_t k = steps.size(); k-- > 0;) {
    const Eigen::Matrix3d J = T_here_end.inverse().adjoint();
    sum += J * steps[k].covariance * J.transpose();
    T_here_end = steps[k].T * T_here_end;
  }
  return sum;
}

TEST(DriftBound, ComposesTheErrorsOfAChainBothWays) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<Step> steps = random_steps(8, seed);
    const DriftBound drift = chain_of(steps);
    const Eigen::Matrix3d expected = composed(steps);
    const PoseSigmas last = drift.seen_from(0)[8];
    EXPECT_NEAR(last.m, worst_sigma(expected), 1e-12);
    EXPECT_NEAR(last.rad, std::sqrt(expected(2, 2)), 1e-12);
    std::vector<Step> back;
    for (std::size_t k = steps.size(); k-- > 0;) {
      const Eigen::Matrix3d J = steps[k].T.adjoint();
      back.push_back({steps[k].T.inverse(), J * steps[k].covariance * J.transpose()});
    }
    EXPECT_NEAR(drift.seen_from(8)[0].m, worst_sigma(composed(back)), 1e-12);
  }
}

TEST(DriftBound, TakesTheSurerOfTwoWays) {
  const std::vector<Step> steps = random_steps(30, 7);
  DriftBound drift = chain_of(steps);
  const std::vector<PoseSigmas> open = drift.seen_from(30);
  Se2 T_first_last;
  for (const Step& step : steps) T_first_last = T_first_last * step.T;
  const Eigen::Matrix3d sure = Eigen::Vector3d(1e-6, 1e-6, 1e-8).asDiagonal();
  drift.add_loop(0, 30, T_first_last, sure);
  const std::vector<PoseSigmas> closed = drift.seen_from(30);
  const Eigen::Matrix3d J = T_first_last.adjoint();
  EXPECT_NEAR(closed[0].m, worst_sigma(J * sure * J.transpose()), 1e-12);
  EXPECT_EQ(closed[30].m, 0.0);
  for (std::size_t k = 0; k < 30; ++k) EXPECT_LE(closed[k].m, open[k].m + 1e-12) << k;
  EXPECT_LT(closed[3].m, 0.5 * open[3].m);
}

NodeId node(std::uint64_t index) { return {{}, index}; }

// Poses a metre apart along x; the newer half really lies `off_m` to the left.
struct Corridor {
  LoopStories::Map map{
      [](const NodeId& n) { return Se2(static_cast<double>(n.index % 100), 0, 0); }};
  static Sighting sighting(std::uint64_t from, double off_m) {
    return {node(from), node(100 + from), Se2(0.0, off_m, 0.0), Eigen::Matrix3d::Identity()};
  }
};

TEST(LoopStories, AreToldWhenEnoughAgreeOverAWay) {
  LoopStories stories({.least_agreeing = 3, .least_way_m = 4.0});
  const Corridor corridor;
  EXPECT_TRUE(stories.hear(corridor.sighting(0, 2.0), corridor.map).empty());
  EXPECT_TRUE(stories.hear(corridor.sighting(1, 2.1), corridor.map).empty());
  EXPECT_TRUE(stories.hear(corridor.sighting(2, 2.0), corridor.map).empty()) << "2 m of way";
  EXPECT_EQ(stories.hear(corridor.sighting(5, 1.9), corridor.map).size(), 4u) << "all at once";
  EXPECT_EQ(stories.hear(corridor.sighting(6, 2.0), corridor.map).size(), 1u) << "then the new one";
}

TEST(LoopStories, KeepSilentWhileAnotherIsAboutAsLong) {
  LoopStories stories({.least_agreeing = 3, .least_way_m = 1.0});
  const Corridor corridor;
  for (const std::uint64_t k : {0u, 2u})
    EXPECT_TRUE(stories.hear(corridor.sighting(k, -3.0), corridor.map).empty());
  for (const std::uint64_t k : {0u, 1u, 2u, 3u, 4u})
    EXPECT_TRUE(stories.hear(corridor.sighting(k, 2.0), corridor.map).empty()) << k;
  EXPECT_EQ(stories.hear(corridor.sighting(5, 2.0), corridor.map).size(), 6u) << "2 of 6 by now";
}

TEST(LoopStories, KeepSilentWhenContradicted) {
  LoopStories stories({.least_agreeing = 2, .least_way_m = 1.0});
  Corridor corridor;
  corridor.map.contradicts = [](const Sighting& newest) { return newest.T_from_to.y() > 0.0; };
  for (const std::uint64_t k : {0u, 1u, 2u, 3u})
    EXPECT_TRUE(stories.hear(corridor.sighting(k, 2.0), corridor.map).empty());
  EXPECT_TRUE(stories.hear(corridor.sighting(0, -2.0), corridor.map).empty());
  EXPECT_EQ(stories.hear(corridor.sighting(1, -2.0), corridor.map).size(), 2u)
      << "a story that cannot be is no rival";
}

void add_box(FloorPlan& plan, const Eigen::Vector2d& corner, const Eigen::Vector2d& size) {
  const Eigen::Vector2d x(size.x(), 0.0), y(0.0, size.y());
  for (const auto& [from, to] : {std::pair<Eigen::Vector2d, Eigen::Vector2d>{corner, corner + x},
                                 {corner + x, corner + size},
                                 {corner + size, corner + y},
                                 {corner + y, corner}})
    plan.walls.push_back({from, to});
}

// Four corridors around a core, 100 m x 40 m; the northern one is bare, cupboards stand in the
// others. The tour goes around once and 60 m further.
FloorPlan four_corridors() {
  FloorPlan plan;
  add_box(plan, {0.0, 0.0}, {100.0, 40.0});
  add_box(plan, {2.0, 2.0}, {96.0, 36.0});
  double x = 3.0;
  for (int i = 0; x < 96.0; x += 2.3 + 0.7 * (i * 7 % 5), ++i)
    add_box(plan, {x, i % 3 != 0 ? 0.0 : 1.6}, {0.3 + 0.1 * (i % 4), 0.4});
  double y = 3.0;
  for (int i = 0; y < 36.0; y += 2.1 + 0.6 * (i * 5 % 7), ++i) {
    add_box(plan, {i % 2 != 0 ? 0.0 : 1.6, y}, {0.4, 0.3 + 0.1 * (i % 3)});
    add_box(plan, {98.0 + (i % 3 != 0 ? 0.0 : 1.6), y + 1.0}, {0.4, 0.4});
  }
  plan.tour = {{4, 1}, {99, 1}, {99, 39}, {1, 39}, {1, 1}, {60, 1}};
  return plan;
}

TEST(LaserFarLoops, CloseALoopThatDriftedByMetres) {
  DriveOptions options{.seed = 4, .plan = four_corridors()};
  options.wheels.length_m = 0.15;
  const SimulatedDrive drive = simulate_drive(options);
  LaserTracker tracker;
  std::vector<Se2> tracked;
  for (const LaserScan& scan : drive.scans) tracked.push_back(tracker.track(scan).T_odom_laser);
  const Se2 truth = drive.truth.front().inverse() * drive.truth.back();
  const Se2 drifted = tracked.front().inverse() * tracked.back();
  EXPECT_GT((truth.inverse() * drifted).translation().norm(), 3.0) << "too easy";

  LaserFrontend frontend;
  test::OfflineFrontendHost host;
  const auto done = host.run(frontend, drive.scans);
  ASSERT_TRUE(done) << done.error().to_string();
  const std::vector<Se2> found = host.trajectory();
  EXPECT_LT((truth.inverse() * (found.front().inverse() * found.back())).translation().norm(), 0.3);
  EXPECT_LT(test::aligned_rmse_m(drive.truth, found), 0.4);
}

}  // namespace
}  // namespace cairn
