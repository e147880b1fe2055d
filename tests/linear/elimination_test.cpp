// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/linear/elimination_cache.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "tests/support/reference_solver.hpp"

namespace cairn {
namespace {

BlockGraph grid(int side) {
  std::vector<std::pair<int, int>> pairs;
  for (int i = 0; i < side * side; ++i) {
    if (i % side + 1 < side) pairs.emplace_back(i, i + 1);
    if (i + side < side * side) pairs.emplace_back(i, i + side);
  }
  return BlockGraph::from_pairs(side * side, pairs);
}

bool is_permutation_of_all(std::vector<int> position) {
  std::sort(position.begin(), position.end());
  std::vector<int> all(position.size());
  std::iota(all.begin(), all.end(), 0);
  return position == all;
}

TEST(Elimination, IsAPermutationWhoseColumnCountsEqualADenseSymbolicElimination) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const test::RandomBlockSystem system(60, seed);
    const Elimination& elimination = system.elimination;
    EXPECT_TRUE(is_permutation_of_all(elimination.position)) << "seed " << seed;
    EXPECT_EQ(elimination.count, test::dense_column_counts(system.graph, elimination.position))
        << "seed " << seed;
  }
}

TEST(Elimination, IsPostorderedSoChildrenComeBeforeTheirParentsInOneRun) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const std::vector<int> parent = test::RandomBlockSystem(60, seed).elimination.parent;
    std::vector<int> below(parent.size(), 1);
    for (int j = 0; j < static_cast<int>(parent.size()); ++j) {
      if (parent[j] < 0) continue;
      EXPECT_GT(parent[j], j) << "seed " << seed;
      below[parent[j]] += below[j];
    }
    // In a postorder the last child of a node is right before it.
    for (int j = 0; j < static_cast<int>(parent.size()); ++j) {
      if (below[j] == 1) continue;
      EXPECT_EQ(parent[j - 1], j) << "seed " << seed;
    }
  }
}

TEST(Supernodes, HoldEveryBlockOfTheFactorAndFewZeros) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const test::RandomBlockSystem system(60, seed);
    const Supernodes& supernodes = system.elimination.supernodes;
    const auto filled = test::dense_factor_pattern(system.graph, system.elimination.position);
    ASSERT_EQ(supernodes.first.front(), 0);
    ASSERT_EQ(supernodes.first.back(), 60);
    double held = 0.0, needed = 0.0;
    for (int s = 0; s < supernodes.size(); ++s) {
      const auto rows = supernodes.rows(s);
      EXPECT_TRUE(std::is_sorted(rows.begin(), rows.end()));
      const int last = supernodes.first[s + 1];
      EXPECT_EQ(supernodes.parent[s] < 0, rows.empty());
      for (int j = supernodes.first[s]; j < last; ++j) {
        held += last - j + static_cast<double>(rows.size());
        for (int i = j; i < 60; ++i) {
          if (!filled[i][j]) continue;
          ++needed;
          EXPECT_TRUE(i < last || std::binary_search(rows.begin(), rows.end(), i))
              << "block (" << i << ", " << j << ")";
        }
      }
      if (rows.empty()) continue;
      EXPECT_GE(rows.front(), last);
      EXPECT_GE(rows.front(), supernodes.first[supernodes.parent[s]]);
      EXPECT_LT(rows.front(), supernodes.first[supernodes.parent[s] + 1]);
    }
    EXPECT_LE(held, 1.5 * needed);
  }
}

TEST(Elimination, IsDeterministic) {
  const BlockGraph graph = grid(30);
  const Elimination first = find_elimination(graph), second = find_elimination(graph);
  EXPECT_EQ(first.position, second.position);
  EXPECT_EQ(first.count, second.count);
}

TEST(Elimination, TriesNestedDissectionOnLargeGraphsAndStaysAPermutation) {
  const BlockGraph graph = grid(120);
  const Elimination elimination = find_elimination(graph);
  EXPECT_TRUE(is_permutation_of_all(elimination.position));
  EXPECT_EQ(elimination.position, find_elimination(graph).position);
  EXPECT_EQ(elimination.method, "metis");  // a grid this large is where dissection pays
  // Against a banded elimination, which fills its band of 120.
  EXPECT_LT(elimination.block_operations(), 0.25 * 120.0 * 120.0 * 120.0 * 120.0);
}

TEST(Elimination, LeavesTreesWithoutFill) {
  std::vector<std::pair<int, int>> pairs;
  for (int i = 1; i < 200; ++i) pairs.emplace_back(i, (i - 1) / 2);
  const Elimination elimination = find_elimination(BlockGraph::from_pairs(200, pairs));
  EXPECT_EQ(std::accumulate(elimination.count.begin(), elimination.count.end(), 0), 200 + 199);
}

TEST(Elimination, TakesNoBlocksAndBlocksWithoutNeighbors) {
  EXPECT_TRUE(find_elimination(BlockGraph::from_pairs(0, {})).position.empty());
  EXPECT_THAT(find_elimination(BlockGraph::from_pairs(3, {})).count,
              ::testing::ElementsAre(1, 1, 1));
}

TEST(EliminationCache, AnswersAsWithoutAndRemembersTheLastPatterns) {
  EliminationCache cache;
  for (int round = 0; round < 2; ++round) {
    for (const int side : {5, 6, 7}) {
      const Elimination found = cache.find(grid(side)), expected = find_elimination(grid(side));
      EXPECT_EQ(found.position, expected.position);
      EXPECT_EQ(found.parent, expected.parent);
      EXPECT_EQ(found.supernodes.row, expected.supernodes.row);
    }
  }
  EXPECT_EQ(cache.hits(), 3u);
  EXPECT_EQ(cache.misses(), 3u);
  for (const int side : {8, 9, 10, 11, 5}) (void)cache.find(grid(side));
  EXPECT_EQ(cache.hits(), 3u) << "5 was the oldest of more than it keeps";
}

}  // namespace
}  // namespace cairn
