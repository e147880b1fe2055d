// SPDX-License-Identifier: BSD-3-Clause
// Every variant of iterated closest points, on rooms whose points lie exactly on their walls, on
// simulated scans, and against a referee that asks every point and tries every direction.
#include "frontends/matching/icp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "datasets/random.hpp"
#include "frontends/simulated/simulated_drive.hpp"

namespace cairn {
namespace {

using Points = std::vector<SurfacePoint>;

// At uneven distances along a wall that is seen from its left side.
void add_wall(Points& points, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
              Random& random) {
  const double length = (to - from).norm();
  const Eigen::Vector2d along = (to - from) / length;
  for (double s = random.uniform(0.0, 0.05); s < length; s += random.uniform(0.03, 0.09))
    points.push_back({from + s * along, {-along.y(), along.x()}});
}

Points room() {
  Random random(5);
  Points points;
  const Eigen::Vector2d corners[] = {{-3.0, -2.0}, {4.0, -2.0}, {4.0, 1.0},
                                     {1.0, 1.0},   {1.0, 2.5},  {-3.0, 2.5}};
  for (int k = 0; k < 6; ++k) add_wall(points, corners[k], corners[(k + 1) % 6], random);
  return points;
}

Points with_noise(Points points, double sigma_m, Random& random) {
  for (SurfacePoint& point : points)
    point.position += sigma_m * Eigen::Vector2d(random.normal(), random.normal());
  return points;
}

Se2 draw(Random& random, double m, double rad) {
  return {random.uniform(-m, m), random.uniform(-m, m), random.uniform(-rad, rad)};
}

IcpMatch match(const Points& map, const Points& scan, const Se2& start, const IcpOptions& options) {
  const auto found = match_icp(PointMap(map, 0.6), scan, start, options);
  EXPECT_TRUE(found) << found.error().to_string();
  return found ? *found : IcpMatch{};
}

double metres_apart(const Se2& a, const Se2& b) { return (a.inverse() * b).translation().norm(); }
double radians_apart(const Se2& a, const Se2& b) { return std::abs((a.inverse() * b).theta()); }

std::vector<IcpOptions> variants() {
  using Kind = RobustLoss::Kind;
  std::vector<IcpOptions> all;
  for (const IcpMetric metric : {IcpMetric::kPointToPoint, IcpMetric::kPointToLine})
    for (const IcpPairing pairing : {IcpPairing::kClosest, IcpPairing::kClosestCompatible}) {
      IcpOptions options{.metric = metric, .pairing = pairing};
      all.push_back(options);
      options.keep_share = 0.8;
      all.push_back(options);
      options.keep_share = 1.0;
      for (const RobustLoss loss :
           {RobustLoss(Kind::kHuber, 1.345), RobustLoss(Kind::kCauchy, 2.4),
            RobustLoss(Kind::kGemanMcClure, 2.0), RobustLoss(Kind::kTukey, 4.685)}) {
        options.loss = loss;
        all.push_back(options);
      }
    }
  return all;
}

std::string name(const IcpOptions& options) {
  return "metric " + std::to_string(static_cast<int>(options.metric)) + " pairing " +
         std::to_string(static_cast<int>(options.pairing)) + " keep " +
         std::to_string(options.keep_share) + " loss " +
         std::to_string(static_cast<int>(options.loss.kind()));
}

TEST(Icp, RecoversAKnownMotionExactly) {
  const Points map = room();
  const Se2 truth(0.8, -0.4, 0.7);
  const Points scan = moved(truth.inverse(), map);
  Random random(1);
  for (const IcpOptions& options : variants())
    for (int trial = 0; trial < 3; ++trial) {
      const IcpMatch found = match(map, scan, truth * draw(random, 0.02, 0.005), options);
      EXPECT_EQ(found.stop, IcpStop::kConverged) << name(options);
      EXPECT_LT(metres_apart(found.T_map_scan, truth), 1e-6) << name(options);
      EXPECT_LT(radians_apart(found.T_map_scan, truth), 1e-6) << name(options);
      EXPECT_EQ(found.inliers, static_cast<int>(scan.size())) << name(options);
      EXPECT_EQ(found.free, 0) << name(options);
      EXPECT_LT(found.rms_m, 1e-4) << name(options);
    }
}

TEST(Icp, RecoversMotionsBetweenSimulatedScansWithinNoise) {
  const SimulatedDrive drive = simulate_drive();
  Random random(2);
  for (const std::size_t at : {20u, 300u, 1500u}) {
    const Points map = surface_points(drive.scans[at]), scan = surface_points(drive.scans[at + 2]);
    const Se2 truth = drive.truth[at].inverse() * drive.truth[at + 2];
    for (const IcpOptions& options : variants()) {
      // The closest points of a scan from elsewhere are not the same points of the wall.
      const bool lines = options.metric == IcpMetric::kPointToLine;
      const IcpMatch found = match(map, scan, truth * draw(random, 0.05, 0.02), options);
      EXPECT_LT(metres_apart(found.T_map_scan, truth), lines ? 0.02 : 0.06) << at << name(options);
      EXPECT_LT(radians_apart(found.T_map_scan, truth), lines ? 0.01 : 0.02) << at << name(options);
    }
  }
}

// By brute force: the nearest of all points, and the smallest sum of squares along
// ever shorter steps in each direction.
Se2 match_slowly(const Points& map, const Points& scan, Se2 T, const IcpOptions& options) {
  for (int round = 0; round < 60; ++round) {
    std::vector<std::pair<const SurfacePoint*, const SurfacePoint*>> pairs;
    for (const SurfacePoint& point : scan) {
      const SurfacePoint* best = nullptr;
      double least = options.last_reach_m;
      for (const SurfacePoint& on : map) {
        if (options.pairing == IcpPairing::kClosestCompatible &&
            on.normal.dot(T.rotation() * point.normal) < 0.5)
          continue;
        const double distance = (T * point.position - on.position).norm();
        if (distance <= least) least = distance, best = &on;
      }
      if (best != nullptr) pairs.emplace_back(&point, best);
    }
    const auto cost = [&](const Se2& at) {
      double sum = 0.0;
      for (const auto& [point, on] : pairs) {
        const Eigen::Vector2d e = at * point->position - on->position;
        sum += options.metric == IcpMetric::kPointToLine ? std::pow(on->normal.dot(e), 2)
                                                         : e.squaredNorm();
      }
      return sum;
    };
    for (double step = 0.02; step > 1e-8;) {
      const Se2 before = T;
      for (int k = 0; k < 6; ++k) {
        Eigen::Vector3d d = Eigen::Vector3d::Zero();
        d[k / 2] = k % 2 ? step : -step;
        if (cost(T.retract(d)) < cost(T)) T = T.retract(d);
      }
      if ((before.inverse() * T).log().isZero(1e-15)) step *= 0.5;
    }
  }
  return T;
}

TEST(Icp, AgreesWithASlowReferee) {
  Random random(3);
  const Points map = with_noise(room(), 0.01, random);
  Points scan;
  for (std::size_t i = 0; i < map.size(); i += 3) scan.push_back(map[i]);
  scan = with_noise(scan, 0.01, random);
  for (const IcpOptions& options : variants()) {
    if (options.keep_share < 1.0 || options.loss.kind() != RobustLoss::Kind::kNone) continue;
    const Se2 start = draw(random, 0.08, 0.02);
    const IcpMatch found = match(map, scan, start, options);
    const Se2 slow = match_slowly(map, scan, start, options);
    EXPECT_EQ(found.stop, IcpStop::kConverged);
    EXPECT_LT(metres_apart(found.T_map_scan, slow), 1e-4) << name(options);
    EXPECT_LT(radians_apart(found.T_map_scan, slow), 1e-4) << name(options);
  }
}

// Three of ten echoes are of something 0.1 to 0.4 m before its wall.
TEST(Icp, WithstandsGrossOutliersWhenTrimmedOrRobust) {
  const Points map = room();
  Random random(4);
  Points scan = map;
  for (SurfacePoint& point : scan)
    if (point.normal.x() >= 0.0 && point.normal.y() >= 0.0 && random.chance(0.6))
      point.position += random.uniform(0.1, 0.4) * point.normal;
  std::size_t outliers = 0;
  for (std::size_t i = 0; i < scan.size(); ++i) outliers += scan[i].position != map[i].position;
  EXPECT_NEAR(static_cast<double>(outliers) / static_cast<double>(scan.size()), 0.3, 0.03);
  const auto error = [&](const IcpOptions& options) {
    return metres_apart(match(map, scan, Se2(0.02, -0.02, 0.01), options).T_map_scan, Se2());
  };
  for (const IcpMetric metric : {IcpMetric::kPointToPoint, IcpMetric::kPointToLine}) {
    IcpOptions options{.metric = metric};
    const double plain = error(options);
    EXPECT_GT(plain, 0.03);
    options.keep_share = 0.6;
    EXPECT_LT(error(options), 1e-3);
    options.keep_share = 1.0;
    options.loss = RobustLoss(RobustLoss::Kind::kHuber, 1.345);
    EXPECT_LT(error(options), 0.9 * plain);  // bounded influence is not none
    for (const RobustLoss::Kind kind :
         {RobustLoss::Kind::kCauchy, RobustLoss::Kind::kGemanMcClure}) {
      options.loss = RobustLoss(kind, 1.0);
      EXPECT_LT(error(options), 0.01) << static_cast<int>(kind);
    }
    options.loss = RobustLoss(RobustLoss::Kind::kTukey, 4.685);
    EXPECT_LT(error(options), 1e-3);
  }
}

// The map has both sides of a wall 0.1 m thick, the scan sees one, from a start 0.08 m off.
TEST(Icp, TellsTheSidesOfAThinWallByTheirNormals) {
  Random random(6);
  Points map;
  add_wall(map, {3.0, 0.0}, {-3.0, 0.0}, random);  // seen from below
  add_wall(map, {-2.0, -3.0}, {-2.0, 0.0}, random);
  const Points scan = map;
  add_wall(map, {-3.0, 0.1}, {3.0, 0.1}, random);  // from above
  IcpOptions options;
  for (const IcpMetric metric : {IcpMetric::kPointToPoint, IcpMetric::kPointToLine}) {
    options.metric = metric;
    options.pairing = IcpPairing::kClosest;
    EXPECT_GT(metres_apart(match(map, scan, Se2(0.0, 0.08, 0.0), options).T_map_scan, Se2()), 0.05);
    options.pairing = IcpPairing::kClosestCompatible;
    EXPECT_LT(metres_apart(match(map, scan, Se2(0.0, 0.08, 0.0), options).T_map_scan, Se2()), 0.03);
  }
  EXPECT_LT(metres_apart(match(map, scan, Se2(0.0, 0.08, 0.0), options).T_map_scan, Se2()), 1e-5);
}

TEST(Icp, SaysThatNothingHoldsItAlongACorridor) {
  Random random(8);
  Points map, scan;
  for (Points* points : {&map, &scan}) {
    const double half = points == &map ? 10.0 : 5.0;
    add_wall(*points, {-half, -1.0}, {half, -1.0}, random);
    add_wall(*points, {half, 1.0}, {-half, 1.0}, random);
  }
  for (const IcpOptions& options : variants()) {
    const IcpMatch found = match(map, scan, Se2(0.3, 0.05, 0.02), options);
    EXPECT_EQ(found.free, 1) << name(options);
    ASSERT_TRUE(found.free_direction);
    EXPECT_GT(std::abs(found.free_direction->x()), 0.99) << name(options);
    EXPECT_LT(found.information(0, 0), 1e-3 * found.information(1, 1)) << name(options);
    EXPECT_NEAR(found.T_map_scan.y(), 0.0, 0.005) << name(options);
    EXPECT_NEAR(found.T_map_scan.x(), 0.3, 0.05) << name(options);
  }
}

TEST(Icp, SaysWhenThereIsTooLittleToMatch) {
  const Points points = room();
  const Se2 start(0.1, 0.2, 0.3);
  const auto expect_nothing = [&](const Points& map, const Points& scan) {
    const IcpMatch found = match(map, scan, start, {});
    EXPECT_EQ(found.stop, IcpStop::kTooFewPairs);
    EXPECT_EQ(found.T_map_scan.to_vector(), start.to_vector());
    EXPECT_EQ(found.free, 3);
    EXPECT_TRUE(found.information.isZero());
  };
  expect_nothing({}, points);
  expect_nothing(points, {});
  expect_nothing({}, {});
  expect_nothing(moved(Se2(100.0, 0.0, 0.0), points), points);
  Points broken = points;
  for (SurfacePoint& point : broken) point.position.x() = std::nan("");
  expect_nothing(points, broken);
}

TEST(Icp, ReachesNoFurtherThanTheMap) {
  const Points points = room();
  const Se2 start(0.02, 0.01, 0.005);
  const IcpMatch far =
      match(points, points, start, {.first_reach_m = 1e300, .last_reach_m = 1e300});
  const IcpMatch near = match(points, points, start, {.first_reach_m = 0.6, .last_reach_m = 0.6});
  EXPECT_EQ(far.stop, IcpStop::kConverged);
  EXPECT_EQ(far.T_map_scan.to_vector(), near.T_map_scan.to_vector());
}

TEST(Icp, RefusesOptionsThatMakeNoSense) {
  const PointMap map(room(), 0.5);
  const double infinite = std::numeric_limits<double>::infinity(), nan = std::nan("");
  const auto refused = [&](const IcpOptions& options, const Se2& start = {}) {
    const auto found = match_icp(map, room(), start, options);
    return !found && found.error().code == ErrorCode::kUsage;
  };
  EXPECT_FALSE(refused({}));
  EXPECT_TRUE(refused({.last_reach_m = 0.0}));
  EXPECT_TRUE(refused({.last_reach_m = nan}));
  EXPECT_TRUE(refused({.first_reach_m = 0.1}));
  EXPECT_TRUE(refused({.first_reach_m = infinite}));
  EXPECT_TRUE(refused({.keep_share = 0.0}));
  EXPECT_TRUE(refused({.keep_share = 1.1}));
  EXPECT_TRUE(refused({.keep_share = nan}));
  EXPECT_TRUE(refused({.loss = RobustLoss(RobustLoss::Kind::kHuber, nan)}));
  EXPECT_TRUE(refused({.sigma_m = -1.0}));
  EXPECT_TRUE(refused({.iterations = 0}));
  EXPECT_TRUE(refused({.least_step_m = 0.0}));
  EXPECT_TRUE(refused({}, Se2(nan, 0.0, 0.0)));
}

}  // namespace
}  // namespace cairn
