// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/linear/scalar_matrix.hpp"

#include <limits>

#include "cairn/core/check.hpp"

namespace cairn {

ScalarPattern ScalarPattern::lower(const BlockPattern& pattern) {
  CAIRN_CHECK(pattern.value_count() < static_cast<std::size_t>(std::numeric_limits<int>::max()),
              "matrix has too many non-zeros for 32-bit indices");
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

}  // namespace cairn
