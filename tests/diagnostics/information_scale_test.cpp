// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/information_scale.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "cairn/solver/marginals.hpp"
#include "cairn/solver/optimize.hpp"
#include "tests/diagnostics/small_graphs.hpp"

namespace cairn {
namespace {

// A ring of poses measured with noise of the given size, every pair of neighbors and of next
// neighbors; the information says sigma 0.1 whatever the noise is.
Graph noisy_ring(double sigma, unsigned seed) {
  constexpr int kPoses = 60;
  Graph graph;
  for (int i = 0; i < kPoses; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kPoses;
    EXPECT_TRUE(graph.add_pose2(VariableId{static_cast<std::uint64_t>(i)},
                                Se2(10 * std::cos(angle), 10 * std::sin(angle), angle)));
  }
  std::mt19937 random(seed);
  std::normal_distribution<double> unit;
  const auto noise = [&](std::mt19937& engine) { return sigma * unit(engine); };
  for (int step = 1; step <= 2; ++step) {
    for (int i = 0; i < kPoses; ++i) {
      const int j = (i + step) % kPoses;
      const Se2 T_a_b = graph.values().pose2[static_cast<std::size_t>(i)].inverse() *
                        graph.values().pose2[static_cast<std::size_t>(j)];
      const Se2 measured = T_a_b.retract({noise(random), noise(random), noise(random)});
      EXPECT_TRUE(graph.add_factor(
          BetweenSe2{.T_a_b_measured = measured,
                     .information = 100.0 * Eigen::Matrix3d::Identity()},
          {VariableId{static_cast<std::uint64_t>(i)}, VariableId{static_cast<std::uint64_t>(j)}}));
    }
  }
  return graph;
}

TEST(InformationScale, IsAboutOneWhereTheInformationTellsTheTruth) {
  Graph graph = noisy_ring(0.1, 1);
  ASSERT_TRUE(optimize(graph).usable());
  const auto scales = estimate_information_scales(graph);
  ASSERT_EQ(scales.size(), 1u);
  EXPECT_EQ(scales[0].factors, 120u);
  // The median of 120 chi-square variables with 3 degrees of freedom scatters by about 10 %; a
  // factor of two is far outside.
  EXPECT_GT(scales[0].ratio, 0.5);
  EXPECT_LT(scales[0].ratio, 2.0);
}

TEST(InformationScale, GrowsWithTheSquareOfTheNoise) {
  Graph small = noisy_ring(0.01, 2), large = noisy_ring(0.3, 2);
  ASSERT_TRUE(optimize(small).usable());
  ASSERT_TRUE(optimize(large).usable());
  EXPECT_NEAR(std::log10(estimate_information_scales(small).at(0).ratio), -2.0, 0.3);
  EXPECT_NEAR(std::log10(estimate_information_scales(large).at(0).ratio), std::log10(9.0), 0.3);
}

TEST(InformationScale, OutliersInAMinorityDoNotMoveIt) {
  Graph graph = noisy_ring(0.1, 3);
  ASSERT_TRUE(optimize(graph).usable());
  for (std::uint64_t i = 0; i < 10; ++i) test::add_between(graph, i, i + 30, Se2(50.0, 0.0, 1.0));
  EXPECT_LT(estimate_information_scales(graph).at(0).ratio, 2.5);
}

TEST(InformationScale, SaysNothingAboutATree) {
  Graph graph = test::chain({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
  for (std::uint64_t i = 0; i < 11; ++i) test::add_between(graph, i, i + 1, Se2(2.0, 0.0, 0.0));
  EXPECT_TRUE(estimate_information_scales(graph).empty());
}

TEST(InformationScale, SaysNothingAboutNoiseFreeData) {
  Graph graph = noisy_ring(0.0, 4);
  EXPECT_TRUE(estimate_information_scales(graph).empty());
}

TEST(InformationScale, WithMarginalsJudgesEachFactorByItsOwnRedundancy) {
  // A long chain hangs on a ring: the chain's edges are measured once, and must not drag the
  // estimate down.
  Graph graph = noisy_ring(0.1, 5);
  for (std::uint64_t i = 60; i < 400; ++i) {
    ASSERT_TRUE(graph.add_pose2(VariableId{i}, graph.values().pose2[i - 1] * Se2(1.0, 0.0, 0.0)));
    ASSERT_TRUE(graph.add_factor(BetweenSe2{.T_a_b_measured = Se2(1.0, 0.0, 0.0),
                                            .information = 100.0 * Eigen::Matrix3d::Identity()},
                                 {VariableId{i - 1}, VariableId{i}}));
  }
  ASSERT_TRUE(optimize(graph).usable());
  const auto marginals = Marginals::compute(graph);
  ASSERT_TRUE(marginals) << marginals.error().message;
  const auto scales = estimate_information_scales(graph, &*marginals);
  ASSERT_EQ(scales.size(), 1u);
  EXPECT_EQ(scales[0].factors, 120u) << "edges of the chain have no redundancy";
  EXPECT_GT(scales[0].ratio, 0.5);
  EXPECT_LT(scales[0].ratio, 2.0);
}

}  // namespace
}  // namespace cairn
