// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "cairn/linear/block_pattern.hpp"
#include "cairn/linear/elimination.hpp"

namespace cairn::test {

/// The slow, obvious referees beside the sparse code.

/// The whole symmetric matrix behind a pattern and its values.
inline Eigen::MatrixXd to_dense(const BlockPattern& pattern, const std::vector<double>& values) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(pattern.scalar_size(), pattern.scalar_size());
  for (int j = 0; j < pattern.size(); ++j) {
    const Eigen::Map<const Eigen::MatrixXd> panel(values.data() + pattern.value_begin[j],
                                                  pattern.height[j], pattern.dimension[j]);
    for (int k = pattern.column_begin[j]; k < pattern.column_begin[j + 1]; ++k) {
      const int i = pattern.row[k];
      const auto block = panel.middleRows(pattern.row_offset[k], pattern.dimension[i]);
      const int row = pattern.scalar_begin[i], column = pattern.scalar_begin[j];
      A.block(row, column, block.rows(), block.cols()) = block;
      A.block(column, row, block.cols(), block.rows()) = block.transpose();
    }
  }
  return A;
}

/// [row][column] of the Cholesky factor's non-zero blocks in elimination order, found by
/// eliminating one block after the other in a full table.
inline std::vector<std::vector<bool>> dense_factor_pattern(const BlockGraph& graph,
                                                           const std::vector<int>& position) {
  const int n = graph.size();
  std::vector<std::vector<bool>> filled(n, std::vector<bool>(n, false));
  for (int i = 0; i < n; ++i) {
    filled[i][i] = true;
    for (int k = graph.begin[i]; k < graph.begin[i + 1]; ++k)
      filled[position[i]][position[graph.neighbors[k]]] = true;
  }
  for (int j = 0; j < n; ++j) {
    for (int i = j + 1; i < n; ++i) {
      if (!filled[i][j]) continue;
      for (int l = j + 1; l < n; ++l) {
        if (filled[l][j]) filled[i][l] = filled[l][i] = true;
      }
    }
  }
  return filled;
}

/// How many there are in each column.
inline std::vector<int> dense_column_counts(const BlockGraph& graph,
                                            const std::vector<int>& position) {
  const auto filled = dense_factor_pattern(graph, position);
  const int n = graph.size();
  std::vector<int> count(n, 0);
  for (int j = 0; j < n; ++j) {
    for (int i = j; i < n; ++i) count[j] += filled[i][j] ? 1 : 0;
  }
  return count;
}

/// A random sparse block system in elimination order: blocks of 1, 2, 3 and 6 rows, the matrix
/// positive definite by construction (a sum of J^T J over pairs of blocks plus a little identity).
struct RandomBlockSystem {
  RandomBlockSystem(int blocks, std::uint32_t seed)
      : RandomBlockSystem(blocks, map_with_loops(blocks, seed), seed) {}

  RandomBlockSystem(int blocks, std::vector<std::pair<int, int>> coupled, std::uint32_t seed)
      : random(seed), pairs(std::move(coupled)) {
    constexpr int kSizes[] = {1, 2, 3, 6};
    std::vector<int> dimension(blocks);
    for (int& d : dimension) d = kSizes[random() % 4];
    graph = BlockGraph::from_pairs(blocks, pairs);
    elimination = find_elimination(graph);
    pattern = BlockPattern::build(graph, elimination.position, dimension);
    values.assign(pattern.value_count(), 0.0);
    for (int j = 0; j < blocks; ++j) add(j, j, 0.1 * Eigen::MatrixXd::Identity(size(j), size(j)));
    for (const auto& [a, b] : pairs) add_factor(elimination.position[a], elimination.position[b]);
  }

  /// Connected, and about as dense as a map with loops.
  static std::vector<std::pair<int, int>> map_with_loops(int blocks, std::uint32_t seed) {
    std::mt19937 random(seed);
    const auto before = [&](int i) {
      return static_cast<int>(random() % static_cast<unsigned>(i));
    };
    std::vector<std::pair<int, int>> pairs;
    for (int i = 1; i < blocks; ++i) {
      pairs.emplace_back(i, before(i));
      if (i % 3 == 0) pairs.emplace_back(before(i), i);
    }
    return pairs;
  }

  [[nodiscard]] int size(int block) const { return pattern.dimension[block]; }
  Eigen::MatrixXd normal(int rows, int columns) {
    std::normal_distribution<double> distribution;
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return distribution(random); });
  }
  void add(int i, int j, const Eigen::MatrixXd& block) {
    const int entry = pattern.find(i, j);
    Eigen::Map<Eigen::MatrixXd> panel(values.data() + pattern.value_begin[j], pattern.height[j],
                                      size(j));
    panel.middleRows(pattern.row_offset[entry], size(i)) += block;
  }
  void add_factor(int a, int b) {
    const int i = std::max(a, b), j = std::min(a, b);
    const Eigen::MatrixXd J_i = normal(3, size(i)), J_j = normal(3, size(j));
    add(i, i, J_i.transpose() * J_i);
    add(j, j, J_j.transpose() * J_j);
    add(i, j, J_i.transpose() * J_j);
  }

  std::mt19937 random;
  std::vector<std::pair<int, int>> pairs;
  BlockGraph graph;
  Elimination elimination;
  BlockPattern pattern;
  std::vector<double> values;
};

}  // namespace cairn::test
