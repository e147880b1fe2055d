// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "cairn/linear/block_pattern.hpp"

namespace cairn {

/// The block columns of a factor, grouped where neighbors have (nearly) the same rows. Supernode s
/// holds the block columns first[s] .. first[s + 1) in elimination order and, below them, the block
/// rows row[row_begin[s] .. row_begin[s + 1]), ascending. Small groups are merged at the price of
/// some zeros (relaxed supernodes: Ashcraft & Grimes 1989).
struct Supernodes {
  std::vector<int> first;      ///< size() + 1
  std::vector<int> row_begin;  ///< size() + 1
  std::vector<int> row;
  std::vector<int> parent;  ///< the supernode of the first row below, -1 at roots

  [[nodiscard]] int size() const { return static_cast<int>(first.size()) - 1; }
  [[nodiscard]] std::span<const int> rows(int s) const {
    return {row.data() + row_begin[s], row.data() + row_begin[s + 1]};
  }

  /// Of a postordered elimination: the graph block at each place and the place of each block,
  /// elimination tree and blocks per column of the factor.
  static Supernodes find(const BlockGraph& graph, std::span<const int> order,
                         std::span<const int> position, std::span<const int> parent,
                         std::span<const int> count);
};

}  // namespace cairn
