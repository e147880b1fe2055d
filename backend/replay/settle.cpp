// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/replay/settle.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "cairn/core/bytes.hpp"
#include "cairn/core/content_hash.hpp"
#include "cairn/factors/factor_codec.hpp"
#include "cairn/replay/estimate.hpp"
#include "cairn/solver/loop_gate.hpp"
#include "cairn/solver/optimize.hpp"

namespace cairn {
namespace {

std::string_view bytes_of(const std::vector<double>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)};
}

ContentHash hash_of(const StoredNode& node) {
  std::string content(1, static_cast<char>(node.type));
  content += bytes_of(node.start);
  content += '/';
  content += bytes_of(node.odometry);
  return content_hash(content);
}

// Epochs are random: what tells one from another is what it holds. First the smallest index, then
// the content of the node that has it, then that of all nodes.
using EpochRank = std::tuple<std::uint64_t, ContentHash, ContentHash>;

std::map<OdometryFrame, EpochRank> rank_epochs(const PoseGraph& map,
                                               const std::vector<NodeIndex>& counting) {
  std::map<OdometryFrame, std::vector<std::pair<std::uint64_t, NodeIndex>>> nodes;
  for (const NodeIndex i : counting)
    nodes[map.nodes[i].id.frame].emplace_back(map.nodes[i].id.index, i);
  std::map<OdometryFrame, EpochRank> ranks;
  for (auto& [frame, own] : nodes) {
    std::sort(own.begin(), own.end());
    std::string content;
    for (const auto& [index, node] : own) {
      ByteWriter out(content);
      out.integer(index);
      out.hash(hash_of(map.nodes[node]));
    }
    ranks.emplace(frame, EpochRank(own.front().first, hash_of(map.nodes[own.front().second]),
                                   content_hash(content)));
  }
  return ranks;
}

std::vector<NodeIndex> order_nodes(const PoseGraph& map) {
  std::vector<NodeIndex> order = nodes_that_count(map);
  const std::map<OdometryFrame, EpochRank> ranks = rank_epochs(map, order);
  std::vector<const EpochRank*> rank(map.nodes.size());
  for (const NodeIndex i : order) rank[i] = &ranks.at(map.nodes[i].id.frame);
  std::sort(order.begin(), order.end(), [&](NodeIndex a, NodeIndex b) {
    const NodeId &x = map.nodes[a].id, &y = map.nodes[b].id;
    return std::tie(x.frame.robot, *rank[a], x.index) < std::tie(y.frame.robot, *rank[b], y.index);
  });
  return order;
}

std::vector<std::uint32_t> order_factors(const PoseGraph& map,
                                         const std::vector<std::uint32_t>& place_of_node,
                                         const std::function<bool(std::uint32_t)>& takes_part) {
  struct Key {
    std::vector<std::uint32_t> places;
    FactorType type;
    FactorKind kind;
    std::string_view content;
    std::uint32_t factor;
  };
  std::vector<Key> keys;
  for (std::uint32_t f = 0; f < map.factors.size(); ++f) {
    if (!takes_part(f)) continue;
    const StoredFactor& factor = map.factors[f];
    Key key{{}, factor.type, factor.kind, bytes_of(factor.numbers), f};
    for (const NodeIndex node : factor.nodes) key.places.push_back(place_of_node[node]);
    keys.push_back(std::move(key));
  }
  std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
    return std::tie(a.places, a.type, a.kind, a.content) <
           std::tie(b.places, b.type, b.kind, b.content);
  });
  std::vector<std::uint32_t> order;
  for (const Key& key : keys) order.push_back(key.factor);
  return order;
}

// Place by node; of nodes that have none, anything.
std::vector<std::uint32_t> inverse(const std::vector<NodeIndex>& order, const PoseGraph& map) {
  std::vector<std::uint32_t> place(map.nodes.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  return place;
}

// Numbers of the nodes' frames, by place.
std::vector<std::uint32_t> frames_of(const PoseGraph& map, const CanonicalOrder& part) {
  std::map<OdometryFrame, std::uint32_t> numbers;
  std::vector<std::uint32_t> frames;
  for (const NodeIndex node : part.nodes) {
    const auto next = static_cast<std::uint32_t>(numbers.size());
    frames.push_back(numbers.emplace(map.nodes[node].id.frame, next).first->second);
  }
  return frames;
}

// Fills the verdicts, and takes what the gate has left out from the order and the graph.
void take_verdicts(const PoseGraph& map, const GatedSolution& solution, SettledEstimate& settled) {
  const std::vector<std::uint32_t> places = std::exchange(settled.order.factors, {});
  std::vector<bool> kept(places.size(), true);
  for (const LeftOutLoop& loop : solution.left_out) {
    kept[loop.factor] = false;
    const bool waits = loop.test == GateTest::kTooFew;
    LoopVerdict verdict{places[loop.factor],
                        waits ? FactorState::kPending : FactorState::kQuarantined,
                        std::string(to_string(loop.test)), loop.value, loop.threshold};
    for (const std::size_t other : loop.against) verdict.against.push_back(places[other]);
    settled.verdicts.push_back(std::move(verdict));
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!kept[i]) continue;
    settled.order.factors.push_back(places[i]);
    const StoredFactor& stored = map.factors[places[i]];
    if (stored.state == FactorState::kTrusted || !is_gated(stored.type, stored.kind)) continue;
    const auto [batch, index] = settled.graph.factors()[i];
    double chi2 = 0.0;
    settled.graph.batches()[batch]->evaluate_chi2(index, index + 1, {settled.graph.values()},
                                                  &chi2);
    settled.verdicts.push_back(
        {places[i], FactorState::kCommitted, "fits the map", chi2, solution.threshold});
  }
  if (!solution.left_out.empty()) settled.graph = settled.graph.with_factors(kept);
}

bool differs(const Estimate& a, const Estimate& b, double tolerance) {
  return !std::equal(a.begin(), a.end(), b.begin(),
                     [&](double x, double y) { return std::abs(x - y) <= tolerance; });
}

}  // namespace

std::vector<NodeIndex> nodes_that_count(const PoseGraph& map) {
  std::vector<bool> had_factor(map.nodes.size()), has_factor(map.nodes.size());
  for (std::uint32_t f = 0; f < map.factors.size(); ++f) {
    const bool enabled = is_enabled(map.factors[f].state);
    for (const NodeIndex node : map.factors[f].nodes)
      (enabled ? has_factor : had_factor)[node] = true;
  }
  std::vector<NodeIndex> nodes;
  for (NodeIndex i = 0; i < map.nodes.size(); ++i)
    if (has_factor[i] || !had_factor[i]) nodes.push_back(i);
  return nodes;
}

CanonicalOrder::CanonicalOrder(const PoseGraph& map)
    : CanonicalOrder(map, [&](std::uint32_t f) { return is_enabled(map.factors[f].state); }) {}

CanonicalOrder::CanonicalOrder(const PoseGraph& map,
                               const std::function<bool(std::uint32_t)>& takes_part)
    : nodes(order_nodes(map)), factors(order_factors(map, inverse(nodes, map), takes_part)) {}

Graph canonical_graph(const PoseGraph& map, const CanonicalOrder& order) {
  Graph graph;
  graph.reserve(order.nodes.size());
  for (std::size_t place = 0; place < order.nodes.size(); ++place) {
    const NodeIndex index = order.nodes[place];
    const StoredNode& node = map.nodes[index];
    const bool frozen = index < map.frozen_nodes;
    const double* const numbers = frozen ? map.estimates[index].data() : node.start.data();
    const auto added =
        add_variable(graph, VariableId{place}, node.type, {numbers, node.start.size()});
    CAIRN_CHECK(added, "a node of the map that a graph refuses");
    graph.set_fixed(*added, frozen);
  }
  const std::vector<std::uint32_t> place_of_node = inverse(order.nodes, map);
  for (const std::uint32_t f : order.factors) {
    const StoredFactor& stored = map.factors[f];
    std::vector<VariableId> ids;
    for (const NodeIndex node : stored.nodes) ids.push_back({place_of_node[node]});
    NewFactor factor;
    factor.type = stored.type;
    // What is trusted is no loop for the gate: a measurement like any other.
    factor.kind = stored.state == FactorState::kTrusted ? FactorKind::kOther : stored.kind;
    factor.numbers = stored.numbers;
    const bool added = add_factor(graph, factor, ids).ok();
    CAIRN_CHECK(added, "a factor of the map that a graph refuses");
  }
  return graph;
}

SolveOptions optimizer_options(const SettleOptions& settling) {
  SolveOptions options{.kernel = Kernel::kPortable, .init = InitMethod::kAuto};
  options.work = settling.work;
  options.eliminations = settling.eliminations;
  if (settling.keep_going)
    options.on_iteration = [ask = settling.keep_going](int, const auto&) { return ask(); };
  return options;
}

SettledEstimate settle(const PoseGraph& map, const SettleOptions& options) {
  return settle(map, CanonicalOrder(map), options);
}

SettledEstimate settle(const PoseGraph& map, CanonicalOrder part, const SettleOptions& options) {
  Graph graph = canonical_graph(map, part);
  if (options.gate == Gate::kOpen) {
    SolveSummary summary = optimize(graph, optimizer_options(options));
    return {std::move(part), std::move(graph), std::move(summary)};
  }
  const GateOptions gate{options.loops_that_merge.value_or(map.loops_that_merge),
                         frames_of(map, part), options.keep_going};
  GatedSolution solution = solve_gated(graph, optimizer_options(options), gate);
  SettledEstimate settled{std::move(part), std::move(graph), std::move(solution.summary)};
  if (settled.summary.usable()) take_verdicts(map, solution, settled);
  return settled;
}

std::vector<std::pair<NodeIndex, Estimate>> estimates_of(const PoseGraph& map,
                                                         const SettledEstimate& settled) {
  std::vector<std::pair<NodeIndex, Estimate>> estimates;
  estimates.reserve(settled.order.nodes.size());
  for (std::uint32_t place = 0; place < settled.order.nodes.size(); ++place)
    if (settled.order.nodes[place] >= map.frozen_nodes)
      estimates.emplace_back(settled.order.nodes[place],
                             to_estimate(describe_value(settled.graph, place)));
  return estimates;
}

std::vector<std::pair<NodeIndex, Estimate>> changed_estimates(const PoseGraph& map,
                                                              const SettledEstimate& settled) {
  return changed_estimates(map, estimates_of(map, settled), 0.0);
}

std::vector<std::pair<NodeIndex, Estimate>> changed_estimates(
    const PoseGraph& map, const std::vector<std::pair<NodeIndex, Estimate>>& estimates,
    double tolerance) {
  std::vector<std::pair<NodeIndex, Estimate>> changed;
  for (const auto& [node, estimate] : estimates)
    if (differs(estimate, map.estimates[node], tolerance)) changed.emplace_back(node, estimate);
  return changed;
}

}  // namespace cairn
