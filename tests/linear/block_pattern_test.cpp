// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/linear/block_pattern.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/reference_solver.hpp"

namespace cairn {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(BlockGraph, HoldsEachPairOnceInBothDirectionsWithoutLoops) {
  const std::vector<std::pair<int, int>> pairs{{2, 0}, {0, 2}, {1, 1}, {3, 0}, {2, 0}};
  const BlockGraph graph = BlockGraph::from_pairs(4, pairs);
  EXPECT_THAT(graph.begin, ElementsAre(0, 2, 2, 3, 4));
  EXPECT_THAT(graph.neighbors, ElementsAre(2, 3, 0, 0));
}

TEST(BlockGraph, MayBeEmptyOrHaveNoPairs) {
  EXPECT_EQ(BlockGraph::from_pairs(0, {}).size(), 0);
  const BlockGraph graph = BlockGraph::from_pairs(3, {});
  EXPECT_THAT(graph.begin, ElementsAre(0, 0, 0, 0));
  EXPECT_THAT(graph.neighbors, IsEmpty());
}

// Graph blocks 0 (3 rows), 1 (2 rows), 2 (1 row); edges 0-1, 0-2; eliminated in the order 1, 2, 0.
TEST(BlockPattern, LaysPanelsOutAsItsCommentSays) {
  const std::vector<std::pair<int, int>> pairs{{0, 1}, {2, 0}};
  const std::vector<int> position{2, 0, 1}, dimension{3, 2, 1};
  const BlockPattern pattern =
      BlockPattern::build(BlockGraph::from_pairs(3, pairs), position, dimension);
  EXPECT_THAT(pattern.dimension, ElementsAre(2, 1, 3));
  EXPECT_THAT(pattern.scalar_begin, ElementsAre(0, 2, 3, 6));
  EXPECT_THAT(pattern.column_begin, ElementsAre(0, 2, 4, 5));
  EXPECT_THAT(pattern.row, ElementsAre(0, 2, 1, 2, 2));
  EXPECT_THAT(pattern.row_offset, ElementsAre(0, 2, 0, 1, 0));
  EXPECT_THAT(pattern.height, ElementsAre(5, 4, 3));
  EXPECT_THAT(pattern.value_begin, ElementsAre(0, 10, 14, 23));
  EXPECT_EQ(pattern.find(2, 0), 1);
  EXPECT_EQ(pattern.find(2, 1), 3);
}

TEST(BlockPattern, DiesWhenAskedForABlockItDoesNotHave) {
  const std::vector<int> position{0, 1}, dimension{3, 3};
  const BlockPattern pattern =
      BlockPattern::build(BlockGraph::from_pairs(2, {}), position, dimension);
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_DEATH(static_cast<void>(pattern.find(1, 0)), "not in the pattern");
}

TEST(Multiply, EqualsTheDenseProduct) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    test::RandomBlockSystem system(40, seed);
    const Eigen::VectorXd x = system.normal(system.pattern.scalar_size(), 1);
    Eigen::VectorXd y(x.size());
    multiply(system.pattern, system.values.data(), x.data(), y.data());
    const Eigen::VectorXd expected = test::to_dense(system.pattern, system.values) * x;
    EXPECT_LT((y - expected).norm(), 1e-13 * expected.norm()) << "seed " << seed;
  }
}

}  // namespace
}  // namespace cairn
