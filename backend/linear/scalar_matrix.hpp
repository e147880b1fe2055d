// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

}  // namespace cairn
