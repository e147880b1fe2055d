// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cairn/graph/graph.hpp"
#include "cairn/graph/pose_graph.hpp"
#include "cairn/solver/solve_options.hpp"
#include "cairn/solver/solve_summary.hpp"

namespace cairn {

/// Nodes of which something is known, ascending: not those of which all factors were switched off.
std::vector<NodeIndex> nodes_that_count(const PoseGraph& map);

/// The order in which a map is written down, whoever sent it first: nodes by robot name, then
/// odometry epoch (by the smallest index and content it holds, never by its random value), then
/// index; factors by their nodes, type and content. Arrival order, keys and times take no part.
struct CanonicalOrder {
  std::vector<NodeIndex> nodes;        ///< but those whose factors are all switched off
  std::vector<std::uint32_t> factors;  ///< places in PoseGraph::factors; not switched off

  CanonicalOrder() = default;
  explicit CanonicalOrder(const PoseGraph& map);
  /// Only those that `takes_part` (a place in PoseGraph::factors).
  CanonicalOrder(const PoseGraph& map, const std::function<bool(std::uint32_t)>& takes_part);
};

/// What the gate says of a loop closure.
struct LoopVerdict {
  std::uint32_t factor = 0;  ///< place in PoseGraph::factors
  FactorState state = FactorState::kPending;
  std::string test;                      ///< in words
  double value = 0.0;                    ///< that was tested
  double threshold = 0.0;                ///< against this
  std::vector<std::uint32_t> against{};  ///< loops that contradict it
};

/// The enabled part of a map as a graph whose variable ids are places in the canonical order, at
/// the start values that were sent. Frozen nodes are fixed at their estimates;
/// trusted loop closures are FactorKind::kOther there.
Graph canonical_graph(const PoseGraph& map, const CanonicalOrder& order);

/// The settled estimate: a function of the set of nodes and enabled factors, and of the estimates
/// of what is frozen, bit for bit.
struct SettledEstimate {
  CanonicalOrder order;                 ///< without the factors that the gate has left out
  Graph graph;                          ///< as canonical_graph(), optimized
  SolveSummary summary;                 ///< not usable: take nothing from the rest
  std::vector<LoopVerdict> verdicts{};  ///< of every loop closure that the gate decides about
};

/// Which loop closures an estimate is to have in it.
enum class Gate : std::uint8_t {
  kOpen,   ///< all of them
  kWhole,  ///< those that fit together, of all of them: a function of the set
  kQuick,  ///< those that are in and what is new, where it fits them; else as kWhole. solve_map()
};

/// How a map is solved. None of it is owned.
struct SettleOptions {
  Gate gate = Gate::kWhole;
  std::optional<std::size_t> loops_that_merge{};  ///< else as the map's last solve had it
  /// Asked now and then; false leaves an unusable, interrupted result.
  std::function<bool()> keep_going{};
  WorkBudget* work = nullptr;                ///< where it is spent, the same with kWorkLimit
  EliminationCache* eliminations = nullptr;  ///< kept from one solve to the next

  [[nodiscard]] SettleOptions with(Gate other) const {
    SettleOptions options = *this;
    options.gate = other;
    return options;
  }
};

/// Batch optimization with fixed settings (Levenberg-Marquardt, initialization auto, portable
/// kernel, one thread), and the gate (solver/loop_gate.hpp).
SettledEstimate settle(const PoseGraph& map, const SettleOptions& options = {});
/// The same of a part of the map: whole components, in canonical order.
SettledEstimate settle(const PoseGraph& map, CanonicalOrder part, const SettleOptions& options);
/// The settings of the optimizer.
SolveOptions optimizer_options(const SettleOptions& options);

/// By node, in canonical order; but of what is frozen.
std::vector<std::pair<NodeIndex, Estimate>> estimates_of(const PoseGraph& map,
                                                         const SettledEstimate& settled);

/// What a settled estimate changes in a map, by node.
std::vector<std::pair<NodeIndex, Estimate>> changed_estimates(const PoseGraph& map,
                                                              const SettledEstimate& settled);
/// Those of `estimates` that differ from the map's in any number by more than `tolerance` (m, rad,
/// parts of a quaternion); 0: in any bit.
std::vector<std::pair<NodeIndex, Estimate>> changed_estimates(
    const PoseGraph& map, const std::vector<std::pair<NodeIndex, Estimate>>& estimates,
    double tolerance);

}  // namespace cairn
