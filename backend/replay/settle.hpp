// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "cairn/graph/graph.hpp"
#include "cairn/graph/pose_graph.hpp"
#include "cairn/solver/solve_summary.hpp"

namespace cairn {

/// The order in which a map is written down, whoever sent it first: nodes by robot name, then
/// odometry epoch (by the smallest index and content it holds, never by its random value), then
/// index; factors by their nodes, type and content. Arrival order, keys and times take no part.
struct CanonicalOrder {
  std::vector<NodeIndex> nodes;        ///< but those whose factors are all switched off
  std::vector<std::uint32_t> factors;  ///< places in PoseGraph::factors; committed ones only

  CanonicalOrder() = default;
  explicit CanonicalOrder(const PoseGraph& map);
};

/// The enabled part of a map as a graph whose variable ids are places in the canonical order, at
/// the start values that were sent.
Graph canonical_graph(const PoseGraph& map, const CanonicalOrder& order);

/// The settled estimate: a function of the set of nodes and enabled factors only, bit for bit.
struct SettledEstimate {
  CanonicalOrder order;
  Graph graph;           ///< as canonical_graph(), optimized
  SolveSummary summary;  ///< not usable: take nothing from `graph`
};

/// Batch optimization with fixed settings (Levenberg-Marquardt, initialization auto, portable
/// kernel, one thread).
/// `keep_going` is asked after each iteration; false leaves an unusable, interrupted result.
SettledEstimate settle(const PoseGraph& map, const std::function<bool()>& keep_going = {});
/// The same of a part of the map: whole components, in canonical order.
SettledEstimate settle(const PoseGraph& map, CanonicalOrder part,
                       const std::function<bool()>& keep_going);

/// By node, in canonical order.
std::vector<std::pair<NodeIndex, Estimate>> estimates_of(const SettledEstimate& settled);

/// What a settled estimate changes in a map, by node.
std::vector<std::pair<NodeIndex, Estimate>> changed_estimates(const PoseGraph& map,
                                                              const SettledEstimate& settled);
/// Those of `estimates` that differ from the map's in any number by more than `tolerance` (m, rad,
/// parts of a quaternion); 0: in any bit.
std::vector<std::pair<NodeIndex, Estimate>> changed_estimates(
    const PoseGraph& map, const std::vector<std::pair<NodeIndex, Estimate>>& estimates,
    double tolerance);

}  // namespace cairn
