// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/replay/solve_map.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include "cairn/core/disjoint_sets.hpp"
#include "cairn/replay/quick_gate.hpp"

namespace cairn {
namespace {

// Connected components, in the canonical order of their first nodes.
std::vector<CanonicalOrder> parts_of(const PoseGraph& map, const CanonicalOrder& all) {
  DisjointSets sets(map.nodes.size());
  for (const std::uint32_t f : all.factors)
    for (const NodeIndex node : map.factors[f].nodes) sets.join(map.factors[f].nodes[0], node);
  std::vector<CanonicalOrder> parts;
  std::map<std::size_t, std::size_t> part_of_root;
  for (const NodeIndex node : all.nodes) {
    const auto [at, is_new] = part_of_root.emplace(sets.root(node), parts.size());
    if (is_new) parts.emplace_back();
    parts[at->second].nodes.push_back(node);
  }
  for (const std::uint32_t f : all.factors)
    parts[part_of_root.at(sets.root(map.factors[f].nodes[0]))].factors.push_back(f);
  return parts;
}

// Of a part that has factors. Errors that are not even numbers are the largest.
std::uint32_t worst_factor(const PoseGraph& map, const CanonicalOrder& part) {
  const Graph graph = canonical_graph(map, part);
  std::uint32_t worst = part.factors.front();
  double largest = -1.0;
  for (std::size_t i = 0; i < part.factors.size(); ++i) {
    const FactorRef factor = graph.factors()[i];
    const double chi2 = graph.batches()[factor.batch]
                            ->evaluate_cost(factor.index, factor.index + 1, {graph.values()})
                            .chi2;
    if (chi2 <= largest) continue;
    largest = chi2;
    worst = part.factors[i];
    if (!(chi2 <= std::numeric_limits<double>::max())) break;
  }
  return worst;
}

bool is_frozen(const PoseGraph& map, const StoredFactor& factor) {
  return std::all_of(factor.nodes.begin(), factor.nodes.end(),
                     [&](NodeIndex node) { return node < map.frozen_nodes; });
}

void take(const PoseGraph& map, SettledEstimate&& settled, MapSolution& solution) {
  solution.solved = true;
  for (LoopVerdict& verdict : settled.verdicts) {
    if (is_frozen(map, map.factors[verdict.factor])) continue;  // it moves nothing
    const bool is_new = verdict.factor >= map.first_unsolved_factor;
    const bool waits = is_new && verdict.state == FactorState::kPending;
    if (waits || map.factors[verdict.factor].state != verdict.state)
      solution.verdicts.push_back(std::move(verdict));
  }
  const auto found = estimates_of(map, settled);
  solution.estimates.insert(solution.estimates.end(), found.begin(), found.end());
  solution.chi2 += settled.summary.final_chi2;
  for (UnderConstrainedVariable& variable : settled.summary.under_constrained)
    solution.free.push_back(
        {settled.order.nodes[variable.id.value], std::move(variable.free_directions)});
}

// By somebody, or by the limit of its work: where it got to depends on more than the map.
bool was_ended(const SolveSummary& summary) {
  return summary.stop_reason == StopReason::kInterrupted ||
         summary.stop_reason == StopReason::kWorkLimit;
}

// Without estimates where the short way does not lead there.
MapSolution solve_quickly(const PoseGraph& map, const SettleOptions& options) {
  MapSolution solution;
  std::optional<SettledEstimate> settled = try_newcomers(map, options);
  if (!settled) return solution;
  solution.whole = settled->summary;
  if (solution.whole.usable() && !was_ended(solution.whole))
    take(map, std::move(*settled), solution);
  return solution;
}

}  // namespace

MapSolution solve_map(const PoseGraph& map, const SettleOptions& options) {
  if (options.gate == Gate::kQuick) {
    MapSolution quick = solve_quickly(map, options);
    if (quick.usable() || was_ended(quick.whole)) return quick;
    return solve_map(map, options.with(Gate::kWhole));
  }
  MapSolution solution;
  SettledEstimate settled = settle(map, options);
  solution.whole = settled.summary;
  if (was_ended(solution.whole)) return solution;
  const auto by_factor = [&] {
    std::sort(solution.verdicts.begin(), solution.verdicts.end(),
              [](const LoopVerdict& a, const LoopVerdict& b) { return a.factor < b.factor; });
  };
  if (solution.whole.usable()) {
    take(map, std::move(settled), solution);
    by_factor();
    return solution;
  }
  for (CanonicalOrder& part : parts_of(map, settled.order)) {
    SettledEstimate own = settle(map, std::move(part), options);
    if (was_ended(own.summary)) {
      MapSolution nothing;
      nothing.whole = std::move(own.summary);
      return nothing;
    }
    if (own.summary.usable()) {
      take(map, std::move(own), solution);
    } else {
      const std::uint32_t worst = worst_factor(map, own.order);
      solution.unsolved.push_back({std::move(own.order.nodes), own.summary.stop_reason, worst});
    }
  }
  by_factor();
  return solution;
}

}  // namespace cairn
