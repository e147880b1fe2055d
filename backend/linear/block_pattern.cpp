// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/linear/block_pattern.hpp"

#include <algorithm>
#include <numeric>

#include "cairn/core/check.hpp"

namespace cairn {

BlockGraph BlockGraph::from_pairs(int size, std::span<const std::pair<int, int>> pairs) {
  std::vector<int> begin(static_cast<std::size_t>(size) + 2, 0);
  for (const auto& [i, j] : pairs) {
    if (i == j) continue;
    ++begin[i + 2];
    ++begin[j + 2];
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<int> neighbors(static_cast<std::size_t>(begin.back()));
  for (const auto& [i, j] : pairs) {
    if (i == j) continue;
    neighbors[begin[i + 1]++] = j;
    neighbors[begin[j + 1]++] = i;
  }
  begin
      .pop_back();  // begin[i + 1] has moved to the end of list i, which is where list i + 1 begins
  BlockGraph graph{std::move(begin), std::move(neighbors)};
  int kept = 0;
  for (int i = 0, first = 0; i < size; ++i) {
    const int last = graph.begin[i + 1];
    std::sort(graph.neighbors.begin() + first, graph.neighbors.begin() + last);
    for (int k = first; k < last; ++k) {
      if (k == first || graph.neighbors[k] != graph.neighbors[kept - 1]) {
        graph.neighbors[kept++] = graph.neighbors[k];
      }
    }
    first = last;
    graph.begin[i + 1] = kept;
  }
  graph.neighbors.resize(static_cast<std::size_t>(kept));
  return graph;
}

int BlockPattern::find(int i, int j) const {
  const auto first = row.begin() + column_begin[j];
  const auto last = row.begin() + column_begin[j + 1];
  const auto found = std::lower_bound(first, last, i);
  CAIRN_CHECK(found != last && *found == i, "block is not in the pattern");
  return static_cast<int>(found - row.begin());
}

namespace {

// Visiting rows in ascending order keeps every column sorted without sorting.
void fill_rows(const BlockGraph& graph, std::span<const int> position, BlockPattern& pattern) {
  const int n = graph.size();
  std::vector<int> block_at(n);
  for (int i = 0; i < n; ++i) block_at[position[i]] = i;
  pattern.column_begin.assign(static_cast<std::size_t>(n) + 1, 0);
  for (int j = 0; j < n; ++j) {
    const int block = block_at[j];
    int below = 1;
    for (int k = graph.begin[block]; k < graph.begin[block + 1]; ++k)
      below += position[graph.neighbors[k]] > j;
    pattern.column_begin[j + 1] = pattern.column_begin[j] + below;
  }
  pattern.row.resize(static_cast<std::size_t>(pattern.column_begin[n]));
  std::vector<int> next(pattern.column_begin.begin(), pattern.column_begin.end() - 1);
  for (int i = 0; i < n; ++i) {
    pattern.row[next[i]++] = i;
    const int block = block_at[i];
    for (int k = graph.begin[block]; k < graph.begin[block + 1]; ++k) {
      const int j = position[graph.neighbors[k]];
      if (j < i) pattern.row[next[j]++] = i;
    }
  }
}

}  // namespace

BlockPattern BlockPattern::build(const BlockGraph& graph, std::span<const int> position,
                                 std::span<const int> dimension) {
  const int n = graph.size();
  BlockPattern pattern;
  fill_rows(graph, position, pattern);
  pattern.dimension.resize(n);
  for (int i = 0; i < n; ++i) pattern.dimension[position[i]] = dimension[i];
  pattern.scalar_begin.assign(static_cast<std::size_t>(n) + 1, 0);
  std::partial_sum(pattern.dimension.begin(), pattern.dimension.end(),
                   pattern.scalar_begin.begin() + 1);
  pattern.row_offset.resize(pattern.row.size());
  pattern.height.resize(n);
  pattern.value_begin.assign(static_cast<std::size_t>(n) + 1, 0);
  for (int j = 0; j < n; ++j) {
    int height = 0;
    for (int k = pattern.column_begin[j]; k < pattern.column_begin[j + 1]; ++k) {
      pattern.row_offset[k] = height;
      height += pattern.dimension[pattern.row[k]];
    }
    pattern.height[j] = height;
    pattern.value_begin[j + 1] =
        pattern.value_begin[j] +
        static_cast<std::size_t>(height) * static_cast<std::size_t>(pattern.dimension[j]);
  }
  return pattern;
}

void multiply(const BlockPattern& pattern, const double* values, const double* x, double* y) {
  std::fill_n(y, pattern.scalar_size(), 0.0);
  for (int j = 0; j < pattern.size(); ++j) {
    for (int column = 0; column < pattern.dimension[j]; ++column) {
      const double* panel_column =
          values + pattern.value_begin[j] + static_cast<std::size_t>(column) * pattern.height[j];
      const int own = pattern.scalar_begin[j] + column;
      double dot = 0.0;  // rows below the diagonal block also act as columns
      for (int k = pattern.column_begin[j]; k < pattern.column_begin[j + 1]; ++k) {
        const int first = pattern.scalar_begin[pattern.row[k]];
        const double* block = panel_column + pattern.row_offset[k];
        for (int r = 0; r < pattern.dimension[pattern.row[k]]; ++r) {
          y[first + r] += block[r] * x[own];
          if (pattern.row[k] != j) dot += block[r] * x[first + r];
        }
      }
      y[own] += dot;
    }
  }
}

}  // namespace cairn
