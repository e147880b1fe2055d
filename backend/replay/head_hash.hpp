// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cairn/core/content_hash.hpp"
#include "cairn/graph/pose_graph.hpp"

namespace cairn {

/// The content of a map as one hash: nodes with their estimates, factors with their states. Not
/// part of it: store, era and numbers of revisions, keys of transactions, order of arrival. So two
/// journals can be compared at every revision. Follows a map as it grows, at the cost of what
/// changed.
class HeadHash {
 public:
  /// Takes in the nodes and factors that `map` has more than before.
  void grow(const PoseGraph& map);
  /// As grow(), and looks for estimates and factor states that changed.
  void update(const PoseGraph& map);
  [[nodiscard]] ContentHash value() const;

 private:
  // Hashes add up (mod 2^256): whatever the order, and one can be taken out again.
  using Sum = std::array<std::uint64_t, 4>;
  static void add(Sum& sum, const Sum& term);
  static void subtract(Sum& sum, const Sum& term);
  static Sum hash_node(const PoseGraph& map, NodeIndex node);
  static Sum hash_factor(const PoseGraph& map, std::size_t factor);

  std::vector<Estimate> estimates_;
  std::vector<Sum> node_terms_;
  std::vector<FactorState> states_;
  Sum nodes_{}, factors_{};
};

}  // namespace cairn
