// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace cairn {

/// Undirected graph of the off-diagonal blocks of a symmetric block matrix: both directions, no
/// loops, no repeats.
struct BlockGraph {
  std::vector<int> begin;      ///< size() + 1
  std::vector<int> neighbors;  ///< of block i: neighbors[begin[i] .. begin[i + 1]), ascending

  [[nodiscard]] int size() const { return static_cast<int>(begin.size()) - 1; }
  /// Pairs may repeat and come in any order; i == j is ignored.
  static BlockGraph from_pairs(int size, std::span<const std::pair<int, int>> pairs);
};

/// Where the non-zero blocks of a symmetric matrix are, in elimination order, lower triangle with
/// full diagonal blocks. The values of block column j form one dense column-major panel: height[j]
/// rows by dimension[j] columns, starting at value_begin[j]; its first rows are the diagonal block,
/// then the blocks below in row order.
struct BlockPattern {
  std::vector<int> dimension;            ///< of each block
  std::vector<int> scalar_begin;         ///< size() + 1: first scalar row of each block
  std::vector<int> column_begin;         ///< size() + 1: into row and row_offset
  std::vector<int> row;                  ///< block rows of a column, ascending, the diagonal first
  std::vector<int> row_offset;           ///< scalar row of that block inside the panel
  std::vector<int> height;               ///< scalar rows of each panel, its leading dimension
  std::vector<std::size_t> value_begin;  ///< size() + 1

  [[nodiscard]] int size() const { return static_cast<int>(dimension.size()); }
  [[nodiscard]] int scalar_size() const { return scalar_begin.back(); }
  [[nodiscard]] std::size_t value_count() const { return value_begin.back(); }
  /// Position in `row` of block (i, j), i >= j. The block must exist.
  [[nodiscard]] int find(int i, int j) const;

  /// `position[i]` is the place of graph block i in elimination order, `dimension[i]` its size.
  static BlockPattern build(const BlockGraph& graph, std::span<const int> position,
                            std::span<const int> dimension);
};

/// y = A x for the symmetric A with this pattern and values; x and y differ.
void multiply(const BlockPattern& pattern, const double* values, const double* x, double* y);

}  // namespace cairn
