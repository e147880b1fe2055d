// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/innovation.hpp"

#include <gtest/gtest.h>

#include "cairn/solver/optimize.hpp"
#include "tests/solver/small_problems.hpp"

namespace cairn {
namespace {

// A ring of poses with one loop closure, which is the last factor; everything is a little off.
Graph ring() {
  test::RandomNumbers random(3);
  Graph graph;
  for (std::uint64_t i = 0; i < 12; ++i)
    EXPECT_TRUE(graph.add_pose2({i}, test::Plane::on_circle(0.5 * static_cast<double>(i))));
  const auto tie = [&](std::uint64_t a, std::uint64_t b, FactorKind kind) {
    const Se2 T_a_b = graph.values().pose2[a].inverse() * graph.values().pose2[b];
    const BetweenSe2 factor{T_a_b * Se2::exp(random.vector<3>(1e-2)),
                            1e4 * random.information<3>()};
    EXPECT_TRUE(graph.add_factor(factor, {VariableId{a}, VariableId{b}}, kind));
  };
  for (std::uint64_t i = 0; i + 1 < 12; ++i) tie(i, i + 1, FactorKind::kOdometry);
  tie(11, 0, FactorKind::kLoop);
  return graph;
}

TEST(Innovation, IsTheSameSeenFromTheSolutionWithAndWithoutTheFactor) {
  Graph with = ring();
  const std::size_t last = with.factor_count() - 1;
  std::vector<bool> kept(with.factor_count(), true);
  kept[last] = false;
  Graph without = with.with_factors(kept);
  const SolveSummary solved = optimize(with), solved_without = optimize(without);
  ASSERT_TRUE(solved.usable() && solved_without.usable());
  const auto inside = innovation_inside(with, with.factors()[last], *Marginals::compute(with));
  Graph at = with;
  at.values() = without.values();
  const auto outside = innovation_outside(at, at.factors()[last], *Marginals::compute(without));
  ASSERT_TRUE(inside && outside);
  EXPECT_EQ(inside->dimension, 3);
  EXPECT_EQ(outside->dimension, 3);
  EXPECT_GT(inside->chi2, 0.01);
  EXPECT_NEAR(inside->chi2, outside->chi2, 0.02 * outside->chi2);
  EXPECT_NEAR(inside->redundancy, outside->redundancy, 0.02 * outside->redundancy);
  // It is what the factor costs, too.
  EXPECT_NEAR(solved.final_chi2 - solved_without.final_chi2, outside->chi2, 0.02 * outside->chi2);
  // A loop of 12 relative poses in the plane has three numbers to spare.
  double redundancy = 0.0;
  const auto marginals = Marginals::compute(with);
  for (const FactorRef factor : with.factors())
    redundancy += innovation_inside(with, factor, *marginals)->redundancy;
  EXPECT_NEAR(redundancy, 3.0, 1e-6);
}

TEST(Innovation, OfWhatNothingElseChecksIsNone) {
  Graph graph = ring();
  std::vector<bool> kept(graph.factor_count(), true);
  kept.back() = false;
  graph = graph.with_factors(kept);
  const auto marginals = Marginals::compute(graph);
  for (const FactorRef factor : graph.factors()) {
    const auto innovation = innovation_inside(graph, factor, *marginals);
    ASSERT_TRUE(innovation);
    EXPECT_EQ(innovation->dimension, 0);
    EXPECT_EQ(innovation->chi2, 0.0);
  }
}

}  // namespace
}  // namespace cairn
