// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/conventions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "cairn/geometry/se2.hpp"

namespace cairn {
namespace {

constexpr double kDegreesPerRad = 180.0 / std::numbers::pi;

struct Lap {
  std::vector<std::optional<RawPose2>> poses;
  std::vector<RawEdge2> edges;
};

// Several laps along a rounded square, with an edge to the same place one lap ago; angles in the
// given units.
Lap laps(double pose_unit, double edge_unit, double noise_size = 0.01) {
  constexpr int kPerLap = 24, kPoses = 72;
  std::mt19937 random(7);
  std::normal_distribution<double> unit;
  const auto noise = [&](std::mt19937& engine) { return noise_size * unit(engine); };
  std::vector<Se2> truth{Se2()};
  for (int i = 1; i < kPoses; ++i)
    truth.push_back(truth.back() * Se2(1.0, 0.0, i % 6 == 0 ? std::numbers::pi / 2 : 0.0));
  Lap lap;
  for (const Se2& T : truth) lap.poses.push_back(RawPose2{T.x(), T.y(), T.theta() * pose_unit});
  const auto add = [&](int a, int b) {
    const Se2 T_a_b =
        truth[static_cast<std::size_t>(a)].inverse() * truth[static_cast<std::size_t>(b)];
    lap.edges.push_back({static_cast<std::uint32_t>(a),
                         static_cast<std::uint32_t>(b),
                         {T_a_b.x() + noise(random), T_a_b.y() + noise(random),
                          (T_a_b.theta() + noise(random)) * edge_unit},
                         {100, 0, 0, 50, 0, 400}});
  };
  for (int i = 1; i < kPoses; ++i) add(i - 1, i);
  for (int i = kPerLap; i < kPoses; ++i) add(i - kPerLap + 1, i);
  return lap;
}

TEST(AngleUnits, RadiansAreNotTakenForDegrees) {
  const Lap lap = laps(1.0, 1.0);
  const DegreesVerdict verdict = judge_angle_units(lap.poses, lap.edges);
  EXPECT_FALSE(verdict.vertices);
  EXPECT_FALSE(verdict.edges);
}

TEST(AngleUnits, DegreesInEdgesOnlyAreFound) {
  const Lap lap = laps(1.0, kDegreesPerRad);
  const DegreesVerdict verdict = judge_angle_units(lap.poses, lap.edges);
  EXPECT_FALSE(verdict.vertices);
  EXPECT_TRUE(verdict.edges);
  EXPECT_LT(verdict.misfit_as_degrees, 0.05);
}

TEST(AngleUnits, DegreesInVerticesOnlyAreFound) {
  const Lap lap = laps(kDegreesPerRad, 1.0);
  const DegreesVerdict verdict = judge_angle_units(lap.poses, lap.edges);
  EXPECT_TRUE(verdict.vertices);
  EXPECT_FALSE(verdict.edges);
}

TEST(AngleUnits, DegreesInBothAreFound) {
  const Lap lap = laps(kDegreesPerRad, kDegreesPerRad);
  const DegreesVerdict verdict = judge_angle_units(lap.poses, lap.edges);
  EXPECT_TRUE(verdict.vertices);
  EXPECT_TRUE(verdict.edges);
}

TEST(AngleUnits, DegreesInAFileWithEdgesOnlyAreFoundByItsLoops) {
  Lap lap = laps(1.0, kDegreesPerRad);
  lap.poses.assign(lap.poses.size(), std::nullopt);
  EXPECT_TRUE(judge_angle_units(lap.poses, lap.edges).edges);
  Lap in_radians = laps(1.0, 1.0);
  in_radians.poses.assign(in_radians.poses.size(), std::nullopt);
  EXPECT_FALSE(judge_angle_units(in_radians.poses, in_radians.edges).edges);
}

TEST(AngleUnits, ABadStartAloneIsNoReasonToSuspectDegrees) {
  Lap lap = laps(1.0, 1.0);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> angle(-3.0, 3.0);
  for (auto& pose : lap.poses) pose->angle = angle(random);
  const DegreesVerdict verdict = judge_angle_units(lap.poses, lap.edges);
  EXPECT_FALSE(verdict.vertices);
  EXPECT_FALSE(verdict.edges);
}

TEST(InformationOrder, ReorderingGoesThereAndBack) {
  const std::array<double, 6> row_major{1, 2, 3, 4, 5, 6};
  const auto toro = reorder_planar_information(row_major, PlanarOrder::kToro);
  EXPECT_EQ(reorder_planar_information(toro, PlanarOrder::kRowMajor), row_major);
  EXPECT_EQ(planar_information(toro, PlanarOrder::kToro),
            planar_information(row_major, PlanarOrder::kRowMajor));
}

TEST(InformationOrder, TheRightOrderIsNotDoubted) {
  const Lap lap = laps(1.0, 1.0);
  EXPECT_EQ(judge_information_order(lap.poses, lap.edges, PlanarOrder::kRowMajor),
            OrderVerdict::kAsGiven);
}

TEST(InformationOrder, AnImpossibleOrderIsFoundByDefiniteness) {
  const Lap lap = laps(1.0, 1.0);
  EXPECT_EQ(judge_information_order(lap.poses, lap.edges, PlanarOrder::kToro),
            OrderVerdict::kSwapped);
}

TEST(InformationOrder, WhereBothArePossibleTheResidualsDecide) {
  Lap lap = laps(1.0, 1.0, 0.0);
  const std::array<double, 6> numbers{100.0,   0.0, 9.0,
                                      10000.0, 0.0, 100.0};  // definite in both orders
  // Noise with the covariance they mean in TORO's order: [[0.01, 0, 0], [0, 0.125, -0.00125], [0,
  // -0.00125, 0.0001125]].
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (RawEdge2& edge : lap.edges) {
    const double y = std::sqrt(0.125) * normal(random);
    edge.measured.x += 0.1 * normal(random);
    edge.measured.y += y;
    edge.measured.angle += -0.01 * y + 0.01 * normal(random);
    edge.information = numbers;
  }
  EXPECT_EQ(judge_information_order(lap.poses, lap.edges, PlanarOrder::kToro),
            OrderVerdict::kAsGiven);
  EXPECT_EQ(judge_information_order(lap.poses, lap.edges, PlanarOrder::kRowMajor),
            OrderVerdict::kPlausible);
}

TEST(QuaternionOrder, SmallTurnsWithWFirstAreRecognized) {
  std::vector<Eigen::Vector4d> w_first, w_last;
  for (int i = 0; i < 20; ++i) {
    const double half = 0.01 * i;
    w_first.emplace_back(std::cos(half), std::sin(half), 0.0, 0.0);
    w_last.emplace_back(std::sin(half), 0.0, 0.0, std::cos(half));
  }
  EXPECT_TRUE(quaternions_look_w_first(w_first));
  EXPECT_FALSE(quaternions_look_w_first(w_last));
}

}  // namespace
}  // namespace cairn
