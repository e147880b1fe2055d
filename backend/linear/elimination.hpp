// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "cairn/linear/block_pattern.hpp"
#include "cairn/linear/supernodes.hpp"

namespace cairn {

/// An order of elimination and what it costs.
struct Elimination {
  std::vector<int> position;  ///< of each graph block in elimination order, postordered
  std::vector<int> parent;    ///< elimination tree in elimination order, -1 at roots
  std::vector<int> count;     ///< blocks in each column of the factor, the diagonal included
  Supernodes supernodes;
  std::string_view method;  ///< "amd" or "metis"

  /// Block multiplications of a Cholesky factorization (sum of count^2).
  [[nodiscard]] double block_operations() const;
};

/// Approximate minimum degree; for graphs where factorization dominates, nested dissection is tried
/// too and the cheaper one kept. Deterministic.
Elimination find_elimination(const BlockGraph& graph);

/// Postorders `order` (block at each place) by its elimination tree, counts the factor's columns
/// and groups them.
Elimination analyze_elimination(const BlockGraph& graph, std::span<const int> order,
                                std::string_view method);

}  // namespace cairn
