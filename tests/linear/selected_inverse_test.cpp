// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/linear/selected_inverse.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

namespace cairn {
namespace {

/// A random sparse positive definite block matrix, as the pattern stores it and dense.
struct RandomMatrix {
  Elimination elimination;
  BlockPattern pattern;
  std::vector<double> values;
  Eigen::MatrixXd dense;

  RandomMatrix(int blocks, double pairs_per_block, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> pick(0, blocks - 1);
    std::uniform_int_distribution<int> pick_dimension(0, 2);
    std::vector<std::pair<int, int>> pairs;
    for (int i = 1; i < blocks; ++i) pairs.emplace_back(i - 1, i);
    for (int k = 0; k < static_cast<int>(blocks * pairs_per_block); ++k)
      pairs.emplace_back(pick(random), pick(random));
    std::vector<int> dimension;
    for (int i = 0; i < blocks; ++i)
      dimension.push_back((std::array{2, 3, 6})[pick_dimension(random)]);
    const BlockGraph graph = BlockGraph::from_pairs(blocks, pairs);
    elimination = find_elimination(graph);
    pattern = BlockPattern::build(graph, elimination.position, dimension);
    fill(random);
  }

  void fill(std::mt19937& random) {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const int n = pattern.scalar_size();
    values.resize(pattern.value_count());
    dense = Eigen::MatrixXd::Zero(n, n);
    for (int j = 0; j < pattern.size(); ++j) {
      for (int k = pattern.column_begin[j]; k < pattern.column_begin[j + 1]; ++k) {
        const int i = pattern.row[k];
        Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>> block(
            &values[pattern.value_begin[j] + static_cast<std::size_t>(pattern.row_offset[k])],
            pattern.dimension[i], pattern.dimension[j], Eigen::OuterStride<>(pattern.height[j]));
        block = block.unaryExpr([&](double) { return uniform(random); });
        if (i == j) {
          block = Eigen::MatrixXd(block + block.transpose());
          block.diagonal().array() += 30.0;  // keeps random matrices of this size definite
        }
        dense.block(pattern.scalar_begin[i], pattern.scalar_begin[j], block.rows(), block.cols()) =
            block;
        dense.block(pattern.scalar_begin[j], pattern.scalar_begin[i], block.cols(), block.rows()) =
            block.transpose();
      }
    }
  }
};

TEST(SelectedInverse, EqualsTheDenseInverseOnTheFactorsPattern) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const RandomMatrix random(3 + static_cast<int>(seed) * 4, 0.5, seed);
    const auto solver = make_multifrontal_solver();
    solver->analyze(random.pattern, random.elimination);
    ASSERT_TRUE(solver->factorize(random.values.data())) << "seed " << seed;
    const SelectedInverse inverse(*solver->factor());
    const Eigen::MatrixXd expected = random.dense.inverse();
    for (int j = 0; j < random.pattern.scalar_size(); ++j) {
      for (int i = 0; i < random.pattern.scalar_size(); ++i) {
        const double* entry = inverse.find(i, j);
        // Every non-zero of the matrix is one of the factor.
        ASSERT_TRUE(entry || random.dense(i, j) == 0.0) << i << ", " << j << ", seed " << seed;
        if (entry) {
          EXPECT_NEAR(*entry, expected(i, j), 1e-13) << i << ", " << j << ", seed " << seed;
        }
      }
    }
  }
}

}  // namespace
}  // namespace cairn
