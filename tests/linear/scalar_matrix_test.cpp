// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/linear/scalar_matrix.hpp"

#include <gtest/gtest.h>

#include "cairn/linear/linear_solver.hpp"
#include "tests/support/reference_solver.hpp"

namespace cairn {
namespace {

TEST(BlockRows, ListTheBlocksLeftOfTheDiagonalInOrder) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const test::RandomBlockSystem system(40, seed);
    const BlockPattern& pattern = system.pattern;
    const BlockRows rows(pattern);
    ASSERT_EQ(rows.begin.size(), 41u);
    ASSERT_EQ(rows.column.size(), pattern.row.size() - 40);
    for (int i = 0; i < 40; ++i) {
      for (int k = rows.begin[i]; k < rows.begin[i + 1]; ++k) {
        EXPECT_LT(rows.column[k], i);
        EXPECT_EQ(rows.entry[k], pattern.find(i, rows.column[k]));
        EXPECT_TRUE(k == rows.begin[i] || rows.column[k - 1] < rows.column[k]);
      }
    }
  }
}

TEST(UpperMatrix, HoldsTheUpperTriangleOfADenseMatrix) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    test::RandomBlockSystem system(40, seed);
    UpperMatrix upper(system.pattern, BlockRows(system.pattern));
    upper.take(system.values.data());
    const int n = system.pattern.scalar_size();
    Eigen::MatrixXd found = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i < n; ++i) {
      for (int k = upper.begin[i]; k < upper.begin[i + 1]; ++k) {
        ASSERT_LE(upper.row[k], i);
        ASSERT_TRUE(k == upper.begin[i] || upper.row[k - 1] < upper.row[k]);
        found(upper.row[k], i) = upper.values[k];
      }
    }
    const Eigen::MatrixXd A = test::to_dense(system.pattern, system.values);
    EXPECT_EQ(found, Eigen::MatrixXd(A.triangularView<Eigen::Upper>()));
  }
}

// Columns that are too short would only make CHOLMOD slow, so no other test would see them.
TEST(FactorHeights, EqualADenseSymbolicEliminationAndWhatCholmodStores) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const test::RandomBlockSystem system(40, seed);
    const BlockPattern& pattern = system.pattern;
    const std::vector<int> heights =
        factor_heights(pattern, BlockRows(pattern), system.elimination.parent);
    const auto filled = test::dense_factor_pattern(system.graph, system.elimination.position);
    std::int64_t numbers = 0;
    for (int j = 0; j < 40; ++j) {
      int expected = 0;
      for (int i = j; i < 40; ++i) expected += filled[i][j] ? pattern.dimension[i] : 0;
      EXPECT_EQ(heights[j], expected) << "block " << j;
      for (int c = 0; c < pattern.dimension[j]; ++c) numbers += expected - c;
    }
    const auto solver = make_cholmod_solver();
    solver->analyze(pattern, system.elimination);
    ASSERT_TRUE(solver->factorize(system.values.data()));
    EXPECT_EQ(solver->factor_nonzeros(), numbers);
    EXPECT_EQ(solver->factor()->px.back(), static_cast<std::size_t>(numbers));
  }
}

}  // namespace
}  // namespace cairn
