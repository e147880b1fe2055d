// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/evaluation/relations.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace cairn {
namespace {

Se3 planar(double x, double y, double theta) { return {So3::exp({0.0, 0.0, theta}), {x, y, 0.0}}; }

Trajectory estimate_of(const std::vector<std::pair<std::uint64_t, Se3>>& poses) {
  Trajectory trajectory{.name = "estimate"};
  for (const auto& [stamp, T] : poses) trajectory.poses.push_back({stamp, T});
  return trajectory;
}

Relations truth_of(const std::vector<Relation>& relations) { return {"truth", relations}; }

TEST(RelationErrors, AreZeroForAMovedTruthAndSeeWhatDiffers) {
  const Se3 T_other_map = planar(5.0, -3.0, 2.0);
  const Se3 a = planar(1.0, 2.0, 0.3), b = planar(4.0, 1.0, -2.9);
  const Relations truth = truth_of({{1'000'000, 2'000'000, a.inverse() * b, 1}});
  const auto same = relation_errors(
      truth, estimate_of({{2'000'000, T_other_map * b}, {1'000'000, T_other_map * a}}));
  ASSERT_TRUE(same);
  EXPECT_LT(same->errors.translation_m[0], 1e-12);
  EXPECT_LT(same->errors.rotation_deg[0], 1e-6);

  const auto off = relation_errors(
      truth, estimate_of({{1'000'000, a}, {2'000'000, b * planar(0.3, 0.4, -0.1)}}));
  ASSERT_TRUE(off);
  EXPECT_NEAR(off->errors.translation_m[0], 0.5, 1e-12);
  EXPECT_NEAR(off->errors.rotation_deg[0], 0.1 * 180.0 / std::numbers::pi, 1e-9);
}

TEST(RelationErrors, TakePosesWithinTheToleranceOnlyAndTellWhatIsUnmatched) {
  const Relations truth = truth_of({{10'000, 20'000, Se3(), 1}, {10'000, 90'000, Se3(), 2}});
  const Trajectory estimate = estimate_of({{11'000, Se3()}, {19'000, planar(1.0, 0.0, 0.0)}});
  const auto found = relation_errors(truth, estimate);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->errors.at, std::vector<std::size_t>{0});
  EXPECT_EQ(found->unmatched, std::vector<std::size_t>{1});
  const auto strict = relation_errors(truth, estimate, 999);
  ASSERT_TRUE(strict);
  EXPECT_EQ(strict->unmatched, (std::vector<std::size_t>{0, 1}));
}

TEST(RelationErrors, OfRepeatedStampsTheFirstPoseCounts) {
  const Relations truth = truth_of({{1'000'000, 2'000'000, Se3(), 1}});
  const auto found = relation_errors(
      truth,
      estimate_of({{2'000'000, Se3()}, {1'000'000, Se3()}, {2'000'000, planar(7.0, 0.0, 0.0)}}));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->errors.translation_m[0], 0.0);
}

TEST(RelationErrors, NeedTimeStamps) {
  Trajectory estimate = estimate_of({{1, Se3()}});
  estimate.format = TrajectoryFormat::kKitti;
  const auto found = relation_errors(truth_of({{1, 2, Se3(), 1}}), estimate);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().to_string(),
            "estimate: has no time stamps, which relations are matched by; give a TUM file");
}

}  // namespace
}  // namespace cairn
