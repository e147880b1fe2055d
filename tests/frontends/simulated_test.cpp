// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "datasets/random.hpp"
#include "frontends/simulated/ray_caster.hpp"
#include "frontends/simulated/simulated_drive.hpp"
#include "frontends/simulated/turn.hpp"

namespace cairn {
namespace {

// Asks every wall.
std::optional<RayHit> cast_slowly(const std::vector<Wall>& walls, const Eigen::Vector2d& origin,
                                  const Eigen::Vector2d& direction, double farthest_m,
                                  double beyond_m) {
  std::optional<RayHit> best;
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const auto distance = meet(walls[i], origin, direction);
    if (!distance || *distance <= beyond_m || *distance > farthest_m) continue;
    if (!best || *distance < best->distance_m) best = RayHit{*distance, i};
  }
  return best;
}

void expect_same(const std::optional<RayHit>& fast, const std::optional<RayHit>& slow) {
  ASSERT_EQ(fast.has_value(), slow.has_value());
  if (!fast) return;
  EXPECT_EQ(fast->distance_m, slow->distance_m);
  EXPECT_EQ(fast->wall, slow->wall);
}

TEST(RayCaster, MeetsWhatAskingEveryWallMeets) {
  Random random(7);
  const auto point = [&] {
    return Eigen::Vector2d(random.uniform(-12.0, 12.0), random.uniform(-7.0, 7.0));
  };
  std::size_t hits = 0;
  for (int world = 0; world < 30; ++world) {
    std::vector<Wall> walls;
    for (int i = 0; i < 40; ++i) walls.push_back({point(), point()});
    for (int i = 0; i < 10; ++i) {  // along the axes, and on the borders of cells
      const Eigen::Vector2d a = point().array().round();
      walls.push_back({a, {a.x(), random.uniform(-7.0, 7.0)}});
    }
    const RayCaster caster(walls, random.uniform(0.3, 3.0));
    for (int ray = 0; ray < 300; ++ray) {
      const Eigen::Vector2d origin = ray % 3 ? point() : Eigen::Vector2d(2.0 * point());
      const Eigen::Vector2d direction =
          ray % 7 ? heading(random.uniform(-3.2, 3.2)) : heading(0.5 * M_PI * (ray % 4));
      const double farthest = random.uniform(0.5, 30.0);
      const double beyond = ray % 2 ? 0.0 : random.uniform(0.0, 5.0);
      const auto fast = caster.cast(origin, direction, farthest, beyond);
      expect_same(fast, cast_slowly(walls, origin, direction, farthest, beyond));
      hits += fast.has_value();
    }
  }
  EXPECT_GT(hits, 4000u);
}

TEST(RayCaster, SeesNothingWhereNothingIs) {
  EXPECT_FALSE(RayCaster({}).cast({0.0, 0.0}, {1.0, 0.0}, 10.0));
  const RayCaster one({{{1.0, -1.0}, {1.0, 1.0}}});
  EXPECT_FALSE(one.cast({0.0, 0.0}, {-1.0, 0.0}, 10.0));
  EXPECT_FALSE(one.cast({0.0, 0.0}, {1.0, 0.0}, 0.5));
  EXPECT_FALSE(one.cast({0.0, 0.0}, {1.0, 0.0}, 10.0, 1.0));
  EXPECT_FALSE(one.cast({1.0, -5.0}, {0.0, 1.0}, 10.0));  // along the wall
  EXPECT_EQ(one.cast({0.0, 0.0}, {1.0, 0.0}, 10.0)->distance_m, 1.0);
}

TEST(Heading, IsThatOfTheStandardLibraryToRounding) {
  for (double angle = -13.0; angle <= 13.0; angle += 0.0137) {
    EXPECT_NEAR(heading(angle).x(), std::cos(angle), 2e-15) << angle;
    EXPECT_NEAR(heading(angle).y(), std::sin(angle), 2e-15) << angle;
  }
  EXPECT_EQ(heading(0.0), Eigen::Vector2d(1.0, 0.0));
}

std::uint64_t fingerprint(const SimulatedDrive& drive) {
  std::uint64_t hash = 14695981039346656037ULL;  // FNV-1a
  const auto add = [&](const auto& value) {
    unsigned char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    for (const unsigned char byte : bytes) hash = (hash ^ byte) * 1099511628211ULL;
  };
  for (std::size_t i = 0; i < drive.scans.size(); ++i) {
    add(drive.scans[i].stamp_ns);
    for (const float range : drive.scans[i].ranges_m) add(range);
    for (const Se2& T : {*drive.scans[i].T_odom_laser, drive.truth[i]})
      for (int k = 0; k < 3; ++k) add(T.to_vector()[k]);
  }
  return hash;
}

const SimulatedDrive& office_drive() {
  static const SimulatedDrive drive = simulate_drive();
  return drive;
}

TEST(SimulatedDrive, HasTheSameBitsEverywhere) {
  EXPECT_EQ(fingerprint(office_drive()), fingerprint(simulate_drive()));
  EXPECT_EQ(fingerprint(office_drive()), 0xADF5C7FC31238A43ULL);
}

TEST(SimulatedDrive, AnotherSeedChangesWhatIsMeasuredButNotTheWay) {
  const SimulatedDrive other = simulate_drive({.seed = 2});
  ASSERT_EQ(other.truth.size(), office_drive().truth.size());
  EXPECT_EQ(other.truth.back().to_vector(), office_drive().truth.back().to_vector());
  EXPECT_NE(other.scans.back().T_odom_laser->to_vector(),
            office_drive().scans.back().T_odom_laser->to_vector());
  EXPECT_NE(other.scans[5].ranges_m, office_drive().scans[5].ranges_m);
}

TEST(SimulatedDrive, TakesTwoToThreeMinutesClearOfWallsAndEndsInALoop) {
  const SimulatedDrive& drive = office_drive();
  EXPECT_EQ(drive.scans.size(), drive.truth.size());
  EXPECT_GT(drive.scans.back().stamp_ns, 120'000'000'000);
  EXPECT_LT(drive.scans.back().stamp_ns, 210'000'000'000);
  for (const Se2& T : drive.truth) {
    for (const Wall& wall : drive.plan.walls) {
      const Eigen::Vector2d along = wall.to - wall.from;
      const double share =
          std::clamp(along.dot(T.translation() - wall.from) / along.squaredNorm(), 0.0, 1.0);
      ASSERT_GT((wall.from + share * along - T.translation()).norm(), 0.25)
          << T.to_vector().transpose();
    }
  }
  EXPECT_LT((drive.truth.back().translation() - Eigen::Vector2d(11.0, 5.7)).norm(), 0.2);
}

TEST(SimulatedDrive, TheNorthernCorridorIsBlindAlong) {
  const SimulatedDrive& drive = office_drive();
  std::size_t inside = 0;
  for (std::size_t i = 0; i < drive.truth.size(); ++i) {
    const Se2& T = drive.truth[i];
    if (T.y() < 20.0 || std::abs(T.x() - 17.0) > 3.0) continue;
    ++inside;
    const std::vector<float>& ranges = drive.scans[i].ranges_m;
    EXPECT_EQ(*std::max_element(ranges.begin() + 175, ranges.begin() + 186), 12.0F);
    // All echoes lie on the two walls.
    for (std::size_t beam = 0; beam < ranges.size(); ++beam) {
      if (ranges[beam] == 0.0F || ranges[beam] >= 12.0F) continue;
      const double angle = drive.scans[i].first_angle_rad +
                           static_cast<double>(beam) * drive.scans[i].angle_step_rad;
      const double y = (T * Eigen::Vector2d(ranges[beam] * heading(angle))).y();
      EXPECT_LT(std::min(std::abs(y - 22.0), std::abs(y - 19.8)), 0.06);
    }
  }
  EXPECT_GT(inside, 50u);
}

// A square room without anything; a wall of it may be of glass, with another wall behind.
FloorPlan room(bool glass) {
  FloorPlan plan;
  plan.walls = {{{-3, -3}, {3, -3}},
                {{3, -3}, {3, 3}, glass},
                {{3, 3}, {-3, 3}},
                {{-3, 3}, {-3, -3}},
                {{5, -30}, {5, 30}}};
  for (int i = 0; i < 10; ++i) {
    plan.tour.emplace_back(1.5, 1.0);
    plan.tour.emplace_back(-1.5, -1.0);
  }
  return plan;
}

TEST(SimulatedDrive, RangesHaveTheNoiseThatIsAsked) {
  const SimulatedDrive drive = simulate_drive({.plan = room(false), .laser = {.dropout = 0.01}});
  double sum = 0.0, squares = 0.0, count = 0.0, dropouts = 0.0;
  for (std::size_t i = 0; i < drive.scans.size(); ++i) {
    const LaserScan& scan = drive.scans[i];
    for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
      const double angle = scan.first_angle_rad + static_cast<double>(beam) * scan.angle_step_rad;
      const auto hit = cast_slowly(drive.plan.walls, drive.truth[i].translation(),
                                   heading(drive.truth[i].theta() + angle), 99.0, 0.0);
      count += 1.0;
      dropouts += scan.ranges_m[beam] == 0.0F;
      if (scan.ranges_m[beam] == 0.0F) continue;
      const double error = scan.ranges_m[beam] - hit->distance_m;
      sum += error;
      squares += error * error;
    }
  }
  ASSERT_GT(count, 1e5);
  const double echoes = count - dropouts;
  EXPECT_NEAR(dropouts / count, 0.01, 5.0 * std::sqrt(0.01 / count));
  EXPECT_NEAR(sum / echoes, 0.0, 5.0 * 0.01 / std::sqrt(echoes));
  EXPECT_NEAR(std::sqrt(squares / echoes), 0.01, 1e-4);
}

TEST(SimulatedDrive, GlassIsSeenAsOftenAsIsAsked) {
  const SimulatedDrive drive =
      simulate_drive({.plan = room(true), .laser = {.sigma_m = 0.0, .dropout = 0.0}});
  double seen = 0.0, count = 0.0;
  for (std::size_t i = 0; i < drive.scans.size(); ++i) {
    for (std::size_t beam = 0; beam < drive.scans[i].ranges_m.size(); ++beam) {
      const double angle = drive.scans[i].first_angle_rad +
                           static_cast<double>(beam) * drive.scans[i].angle_step_rad;
      const double x =
          (drive.truth[i] * Eigen::Vector2d(drive.scans[i].ranges_m[beam] * heading(angle))).x();
      const bool on_glass = std::abs(x - 3.0) < 0.01;
      seen += on_glass;
      count += on_glass || x > 3.5;
    }
  }
  ASSERT_GT(count, 1e4);
  EXPECT_NEAR(seen / count, 0.35, 5.0 * std::sqrt(0.35 * 0.65 / count));
}

TEST(SimulatedDrive, OdometryIsTheTruthWithoutNoiseAndDriftsWithIt) {
  WheelNoise none{0, 0, 0, 0, 0, 0, 0, 0};
  const SimulatedDrive exact = simulate_drive({.wheels = none, .laser = {.beams = 2}});
  double worst_m = 0.0;
  for (std::size_t i = 0; i < exact.truth.size(); ++i) {
    const Se2 T_start_true = exact.truth[0].inverse() * exact.truth[i];
    worst_m = std::max(
        worst_m, (T_start_true.translation() - exact.scans[i].T_odom_laser->translation()).norm());
  }
  // The wheels tell the arc between two scans by its chord.
  EXPECT_LT(worst_m, 0.05);
  double sum = 0.0;
  constexpr int kSeeds = 20;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const SimulatedDrive drive =
        simulate_drive({.seed = static_cast<std::uint64_t>(seed), .laser = {.beams = 2}});
    const Se2 T_start_true = drive.truth[0].inverse() * drive.truth.back();
    sum += (T_start_true.translation() - drive.scans.back().T_odom_laser->translation()).norm();
  }
  EXPECT_GT(sum / kSeeds, 0.5);
  EXPECT_LT(sum / kSeeds, 15.0);
}

TEST(Walkers, GoToAndFro) {
  const Walker walker{.corners = {{0, 0}, {3, 0}, {3, 2}}, .speed_m_s = 0.5, .start_m = 1.0};
  EXPECT_EQ(position_of(walker, 0.0), Eigen::Vector2d(1.0, 0.0));
  EXPECT_EQ(position_of(walker, 6.0), Eigen::Vector2d(3.0, 1.0));
  EXPECT_EQ(position_of(walker, 10.0), Eigen::Vector2d(3.0, 1.0));
  EXPECT_EQ(position_of(walker, 20.0), Eigen::Vector2d(1.0, 0.0));
}

}  // namespace
}  // namespace cairn
