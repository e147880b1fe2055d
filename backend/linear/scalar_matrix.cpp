// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/linear/scalar_matrix.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "cairn/core/check.hpp"

namespace cairn {

namespace {

void check_size(const BlockPattern& pattern) {
  CAIRN_CHECK(pattern.value_count() < static_cast<std::size_t>(std::numeric_limits<int>::max()),
              "matrix has too many non-zeros for 32-bit indices");
}

}  // namespace

ScalarPattern ScalarPattern::lower(const BlockPattern& pattern) {
  check_size(pattern);
  ScalarPattern scalar;
  scalar.begin.reserve(static_cast<std::size_t>(pattern.scalar_size()) + 1);
  scalar.row.reserve(pattern.value_count());
  scalar.begin.push_back(0);
  for (int j = 0; j < pattern.size(); ++j) {
    for (int column = 0; column < pattern.dimension[j]; ++column) {
      for (int k = pattern.column_begin[j]; k < pattern.column_begin[j + 1]; ++k) {
        const int first = pattern.scalar_begin[pattern.row[k]];
        for (int r = 0; r < pattern.dimension[pattern.row[k]]; ++r) scalar.row.push_back(first + r);
      }
      scalar.begin.push_back(static_cast<int>(scalar.row.size()));
    }
  }
  return scalar;
}

BlockRows::BlockRows(const BlockPattern& pattern) : begin(pattern.dimension.size() + 2, 0) {
  for (int j = 0; j < pattern.size(); ++j) {
    for (int k = pattern.column_begin[j] + 1; k < pattern.column_begin[j + 1]; ++k)
      ++begin[pattern.row[k] + 2];
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  column.resize(static_cast<std::size_t>(begin.back()));
  entry.resize(column.size());
  for (int j = 0; j < pattern.size(); ++j) {
    for (int k = pattern.column_begin[j] + 1; k < pattern.column_begin[j + 1]; ++k) {
      const int place = begin[pattern.row[k] + 1]++;
      column[place] = j;
      entry[place] = k;
    }
  }
  begin.pop_back();  // begin[i + 1] has moved to the end of row i, where row i + 1 begins
}

// The scalar columns of a block have the same rows, but for those of the diagonal block.
UpperMatrix::UpperMatrix(const BlockPattern& pattern, BlockRows rows)
    : begin(static_cast<std::size_t>(pattern.scalar_size()) + 1),
      row(pattern.value_count()),
      pattern_(pattern),
      rows_(std::move(rows)) {
  check_size(pattern);
  int* next = row.data();
  for (int i = 0; i < pattern.size(); ++i) {
    const int* const first = next;
    for (int k = rows_.begin[i]; k < rows_.begin[i + 1]; ++k) {
      const int j = rows_.column[k];
      for (int c = 0; c < pattern.dimension[j]; ++c) *next++ = pattern.scalar_begin[j] + c;
    }
    const std::ptrdiff_t left = next - first;  // of the diagonal block
    for (int r = 0; r < pattern.dimension[i]; ++r) {
      if (r > 0) next = std::copy_n(first, left, next);
      for (int c = 0; c <= r; ++c) *next++ = pattern.scalar_begin[i] + c;
      begin[pattern.scalar_begin[i] + r + 1] = static_cast<int>(next - row.data());
    }
  }
  row.resize(static_cast<std::size_t>(begin.back()));
  values.resize(row.size());
}

void UpperMatrix::take(const double* pattern_values) {
  for (int i = 0; i < pattern_.size(); ++i) {
    const int* const column = begin.data() + pattern_.scalar_begin[i];
    int at = 0;
    const auto copy = [&](int j, int offset, int r, int columns) {
      const double* from = pattern_values + pattern_.value_begin[j] + offset + r;
      double* to = values.data() + column[r] + at;
      for (int c = 0; c < columns; ++c) to[c] = from[c * pattern_.height[j]];
    };
    for (int k = rows_.begin[i]; k < rows_.begin[i + 1]; ++k) {
      const int j = rows_.column[k], offset = pattern_.row_offset[rows_.entry[k]];
      for (int r = 0; r < pattern_.dimension[i]; ++r) copy(j, offset, r, pattern_.dimension[j]);
      at += pattern_.dimension[j];
    }
    for (int r = 0; r < pattern_.dimension[i]; ++r) copy(i, 0, r, r + 1);
  }
}

// Each row of the factor is a subtree of the elimination tree: walk it once, marking.
std::vector<int> factor_heights(const BlockPattern& pattern, const BlockRows& rows,
                                std::span<const int> parent) {
  std::vector<int> height = pattern.dimension, mark(pattern.dimension.size(), -1);
  for (int i = 0; i < pattern.size(); ++i) {
    mark[i] = i;
    for (int k = rows.begin[i]; k < rows.begin[i + 1]; ++k) {
      for (int j = rows.column[k]; mark[j] != i; j = parent[j]) {
        height[j] += pattern.dimension[i];
        mark[j] = i;
      }
    }
  }
  return height;
}

}  // namespace cairn
