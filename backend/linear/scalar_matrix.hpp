// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "cairn/linear/block_pattern.hpp"

namespace cairn {

/// The compressed columns behind a BlockPattern, for libraries that know scalars only. Its values
/// are the pattern's values, unchanged: lower triangle plus the upper halves of the diagonal
/// blocks.
struct ScalarPattern {
  std::vector<int> begin;
  std::vector<int> row;

  static ScalarPattern lower(const BlockPattern& pattern);
};

/// A BlockPattern by rows: row i has the blocks (i, column[k]) with k in begin[i] .. begin[i + 1),
/// ascending, without the diagonal.
struct BlockRows {
  std::vector<int> begin;
  std::vector<int> column;
  std::vector<int> entry;  ///< of the block in BlockPattern::row

  explicit BlockRows(const BlockPattern& pattern);
};

/// The other triangle, with values of its own: column i holds the rows up to i, ascending.
struct UpperMatrix {
  std::vector<int> begin;
  std::vector<int> row;
  std::vector<double> values;

  UpperMatrix(const BlockPattern& pattern, BlockRows rows);
  /// Copies the values of the pattern, which must live as long as this.
  void take(const double* pattern_values);

 private:
  const BlockPattern& pattern_;
  BlockRows rows_;
};

/// Scalar rows of each block column of the factor, the diagonal block included.
std::vector<int> factor_heights(const BlockPattern& pattern, const BlockRows& rows,
                                std::span<const int> parent);

}  // namespace cairn
