// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/replay/map_head.hpp"

#include <algorithm>
#include <ranges>

#include "cairn/core/check.hpp"
#include "cairn/factors/factor_codec.hpp"
#include "cairn/replay/estimate.hpp"

namespace cairn {
namespace {

constexpr std::size_t kMaxName = 64;

FactorState first_state(FactorType type, FactorKind kind) {
  return is_gated(type, kind) ? FactorState::kPending : FactorState::kCommitted;
}

// How many came with records up to this one.
template <class Stored>
std::size_t count_until(const ChunkedVector<Stored>& all, std::uint64_t record) {
  return *std::ranges::partition_point(std::views::iota(std::size_t{0}, all.size()),
                                       [&](std::size_t i) { return all[i].record <= record; });
}

std::optional<Refusal> check_name(std::string_view what, const std::string& name) {
  if (!name.empty() && name.size() <= kMaxName) return std::nullopt;
  return Refusal{
      RefusalCode::kMalformed,
      std::string(what) + " has " + std::to_string(name.size()) + " bytes; expected 1 to 64"};
}

const NewVariable* find_new(const Transaction& transaction, const NodeId& node) {
  for (const NewVariable& variable : transaction.variables) {
    if (variable.node == node) return &variable;
  }
  return nullptr;
}

}  // namespace

std::optional<NodeIndex> MapHead::find(const NodeId& node) const {
  const auto found = index_of_node_.find(node);
  if (found == index_of_node_.end()) return std::nullopt;
  return found->second;
}

std::optional<Refusal> MapHead::check(const Transaction& transaction) const {
  if (auto refusal = check_name("the source's name", transaction.key.source)) return refusal;
  if (auto refusal = check_variables(transaction)) return refusal;
  if (auto refusal = check_factors(transaction)) return refusal;
  if (auto refusal = check_datum(transaction)) return refusal;
  return check(transaction.edits);
}

std::optional<Refusal> MapHead::check_variables(const Transaction& transaction) const {
  for (const NewVariable& variable : transaction.variables) {
    const std::string name = to_string(variable.node);
    if (auto refusal = check_name("the robot's name", variable.node.frame.robot)) return refusal;
    if (auto fault = find_fault(variable.type, variable.start))
      return Refusal{fault->code, "start of " + name + ": " + fault->reason};
    if (!variable.odometry.empty()) {
      if (auto fault = find_fault(variable.type, variable.odometry))
        return Refusal{fault->code, "odometry of " + name + ": " + fault->reason};
    }
    if (find(variable.node) || find_new(transaction, variable.node) != &variable)
      return Refusal{RefusalCode::kConflict, "the node " + name + " exists already"};
  }
  return std::nullopt;
}

std::optional<VariableType> MapHead::type_of(const NodeId& node,
                                             const Transaction& transaction) const {
  if (const auto index = find(node)) return graph_.nodes[*index].type;
  const NewVariable* added = find_new(transaction, node);
  return added == nullptr ? std::nullopt : std::optional(added->type);
}

// A robot belongs to the source that first added a node of it.
bool MapHead::is_own(const NodeId& node, const Transaction& transaction) const {
  const auto owner = source_of_robot_.find(node.frame.robot);
  if (owner != source_of_robot_.end()) return owner->second == transaction.key.source;
  return std::any_of(transaction.variables.begin(), transaction.variables.end(),
                     [&](const NewVariable& v) { return v.node.frame.robot == node.frame.robot; });
}

std::optional<Refusal> MapHead::check_factors(const Transaction& transaction) const {
  for (std::size_t i = 0; i < transaction.factors.size(); ++i) {
    const NewFactor& factor = transaction.factors[i];
    const std::string place = "factor " + std::to_string(i) + ": ";
    if (auto fault = find_fault(factor)) return Refusal{fault->code, place + fault->reason};
    const FactorTypeInfo& info = *find_factor_type(factor.type);
    for (std::size_t k = 0; k < factor.nodes.size(); ++k) {
      const auto type = type_of(factor.nodes[k], transaction);
      const std::string name = to_string(factor.nodes[k]);
      if (!type) {
        Refusal refusal{RefusalCode::kUnknownVariable,
                        place + "the node " + name + " is not known"};
        if (!is_own(factor.nodes[k], transaction)) refusal.awaited = factor.nodes[k];
        return refusal;
      }
      if (*type != info.signature[k]) {
        return Refusal{RefusalCode::kMalformed, place + std::string(info.name) + " expects a " +
                                                    std::string(to_string(info.signature[k])) +
                                                    " as node " + std::to_string(k) + ", found " +
                                                    std::string(to_string(*type)) + ' ' + name};
      }
    }
  }
  return std::nullopt;
}

// One map, one datum: positions of another would be kilometres off without a word.
std::optional<Refusal> MapHead::check_datum(const Transaction& transaction) const {
  std::optional<Geodetic> expected = graph_.datum;
  for (std::size_t i = 0; i < transaction.factors.size(); ++i) {
    const auto datum = datum_of(transaction.factors[i]);
    if (!datum || datum == expected) continue;
    if (expected)
      return Refusal{RefusalCode::kDatum, "factor " + std::to_string(i) + ": its datum is " +
                                              to_string(*datum) + ", that of this map is " +
                                              to_string(*expected) +
                                              ": send positions in the frame at that datum"};
    expected = datum;
  }
  return std::nullopt;
}

std::optional<Refusal> MapHead::check(std::span<const FactorEdit> edits) const {
  for (const FactorEdit& edit : edits) {
    const auto place = find(edit.factor);
    if (!place || graph_.factors[*place].state == FactorState::kRemoved) {
      return Refusal{RefusalCode::kUnknownVariable,
                     "factor " + std::to_string(edit.factor.index) + " of " +
                         edit.factor.transaction.source + '/' +
                         std::to_string(edit.factor.transaction.sequence) + " is not known"};
    }
  }
  return std::nullopt;
}

// Which factor of the transaction leads to the variable from a node that is known, by odometry.
std::optional<std::uint32_t> MapHead::placing_factor(const NewVariable& variable,
                                                     const Transaction& transaction) const {
  for (std::uint32_t i = 0; i < transaction.factors.size(); ++i) {
    const NewFactor& factor = transaction.factors[i];
    if (factor.kind != FactorKind::kOdometry || factor.nodes.size() != 2) continue;
    const bool forward = factor.nodes[1] == variable.node;
    if (!forward && factor.nodes[0] != variable.node) continue;
    const auto other = find(factor.nodes[forward ? 0 : 1]);
    if (other && compose(graph_.estimates[*other], factor.type, factor.numbers, forward)) return i;
  }
  return std::nullopt;
}

// Where odometry leads to.
std::optional<Estimate> MapHead::composed(NodeIndex node) const {
  if (placed_by_[node] == kNone) return std::nullopt;
  const StoredFactor& factor = graph_.factors[placed_by_[node]];
  const bool forward = factor.nodes[1] == node;
  return compose(graph_.estimates[factor.nodes[forward ? 0 : 1]], factor.type, factor.numbers,
                 forward);
}

void MapHead::advance(const Revision& revision) {
  graph_.graph_revision = revision;
  last_input_ = revision.number;
}

// The last payload is of the last pose, the one before it of the pose before, and so on.
void MapHead::note_payloads(std::span<const ContentHash> payloads,
                            std::span<const NodeIndex> nodes) {
  for (auto node = nodes.rbegin(); node != nodes.rend() && !payloads.empty(); ++node) {
    if (!is_pose(graph_.nodes[*node].type)) continue;
    const ContentHash payload = payloads.back();
    payloads = payloads.first(payloads.size() - 1);
    const auto& known = graph_.nodes[*node].payloads;
    const auto place = std::lower_bound(known.begin(), known.end(), payload) - known.begin();
    if (place < std::ssize(known) && known[static_cast<std::size_t>(place)] == payload) continue;
    auto& all = graph_.nodes.edit(*node).payloads;
    all.insert(all.begin() + place, payload);
  }
}

void MapHead::apply(const Transaction& transaction, const Revision& revision) {
  advance(revision);
  const auto first_new = static_cast<NodeIndex>(graph_.nodes.size());
  const auto first_factor = static_cast<std::uint32_t>(graph_.factors.size());
  for (const NewVariable& variable : transaction.variables) {
    const auto index = static_cast<NodeIndex>(graph_.nodes.size());
    const auto factor = placing_factor(variable, transaction);
    placed_by_.push_back(factor ? first_factor + *factor : kNone);
    graph_.estimates.push_back(to_estimate(variable.start));
    graph_.nodes.push_back({variable.node, revision.number, variable.type, variable.stamp_ns,
                            variable.start, variable.odometry});
    index_of_node_.emplace(variable.node, index);
    source_of_robot_.emplace(variable.node.frame.robot, transaction.key.source);
  }
  records_of_[transaction.key.source].push_back(revision.number);
  if (!transaction.factors.empty())
    first_factor_of_.emplace(transaction.key, graph_.factors.size());
  for (std::uint32_t i = 0; i < transaction.factors.size(); ++i) {
    const NewFactor& factor = transaction.factors[i];
    StoredFactor stored{{transaction.key, i},
                        revision.number,
                        factor.type,
                        factor.kind,
                        first_state(factor.type, factor.kind),
                        {},
                        factor.numbers};
    for (const NodeId& node : factor.nodes) stored.nodes.push_back(*find(node));
    if (const auto datum = datum_of(factor)) graph_.datum = datum;
    note_payloads(factor.payloads, stored.nodes);
    graph_.factors.push_back(std::move(stored));
  }
  compose_from(first_new);
  apply(transaction.edits, revision);
  for (const FactorEdit& edit : transaction.edits)
    switched_by_[*find(edit.factor)] = revision.number;
  if (!transaction.edits.empty()) editing_.insert(revision.number);
}

void MapHead::apply(std::span<const FactorEdit> edits, const Revision& revision) {
  advance(revision);
  for (const FactorEdit& edit : edits) {
    const std::size_t place = *find(edit.factor);
    const StoredFactor& factor = graph_.factors[place];
    switch (edit.change) {
      case FactorChange::kDisable:
        set_state(place, FactorState::kDisabled);
        break;
      case FactorChange::kEnable:
        if (!is_enabled(factor.state)) set_state(place, first_state(factor.type, factor.kind));
        break;
      case FactorChange::kRemove:
        set_state(place, FactorState::kRemoved);
        break;
      case FactorChange::kTrust:
        if (is_enabled(factor.state)) set_state(place, FactorState::kTrusted);
        break;
      case FactorChange::kDoubt:
        if (factor.state == FactorState::kTrusted)
          set_state(place, first_state(factor.type, factor.kind));
        break;
    }
  }
  if (!edits.empty()) note_switch(revision);
}

void MapHead::freeze(NodeIndex nodes, const Revision& revision) {
  advance(revision);
  graph_.frozen_nodes = nodes;
  note_switch(revision);
}

void MapHead::note_switch(const Revision& revision) {
  last_switch_ = revision.number;
  graph_.switched_since_solve = true;
}

void MapHead::judge(std::size_t factor, FactorState state, const Revision& revision) {
  pass_over(revision);
  const FactorState now = graph_.factors[factor].state;
  if (is_enabled(now) && now != FactorState::kTrusted) set_state(factor, state);
}

void MapHead::set_state(std::size_t factor, FactorState state) {
  StoredFactor& stored = graph_.factors.edit(factor);
  const std::string& source = stored.name.transaction.source;
  if (stored.state == FactorState::kQuarantined && --quarantined_[source] == 0)
    quarantined_.erase(source);
  if (state == FactorState::kQuarantined) ++quarantined_[source];
  stored.state = state;
}

void MapHead::commit_loops(const Revision& base) {
  for (std::size_t place = 0; place < graph_.factors.size(); ++place) {
    if (graph_.factors[place].record > base.number) return;
    if (graph_.factors[place].state == FactorState::kPending)
      set_state(place, FactorState::kCommitted);
  }
}

std::optional<std::size_t> MapHead::find(const FactorName& factor) const {
  const auto first = first_factor_of_.find(factor.transaction);
  if (first == first_factor_of_.end()) return std::nullopt;
  const std::size_t place = first->second + factor.index;
  if (place < graph_.factors.size() && graph_.factors[place].name == factor) return place;
  return std::nullopt;
}

std::span<const std::uint64_t> MapHead::records_of(const std::string& source) const {
  const auto found = records_of_.find(source);
  return found == records_of_.end() ? std::span<const std::uint64_t>() : found->second;
}

MapHead::Consequences MapHead::consequences_of(const std::set<std::uint64_t>& records) const {
  Consequences found;
  std::set<std::uint64_t> gone = records;
  const std::size_t first =
      records.empty() ? graph_.factors.size() : count_until(graph_.factors, *records.begin() - 1);
  for (std::size_t f = first; f < graph_.factors.size(); ++f) {
    const std::uint64_t own = graph_.factors[f].record;
    const auto& nodes = graph_.factors[f].nodes;
    const bool depends = std::any_of(nodes.begin(), nodes.end(), [&](NodeIndex node) {
      return gone.contains(graph_.nodes[node].record);
    });
    if (depends) gone.insert(own);
  }
  for (std::size_t f = first; f < graph_.factors.size(); ++f) {
    if (gone.contains(graph_.factors[f].record) && is_enabled(graph_.factors[f].state))
      found.factors.push_back(f);
  }
  for (const auto& [place, by] : switched_by_)
    if (gone.contains(graph_.factors[place].record)) found.edited_by = by;
  for (const std::uint64_t record : gone)
    if (editing_.contains(record)) found.edited_by = record;
  std::ranges::set_difference(gone, records, std::back_inserter(found.dependents));
  return found;
}

void MapHead::apply_estimates(std::span<const std::pair<NodeIndex, Estimate>> changed,
                              const Revision& base, const Revision& revision) {
  for (const auto& [node, estimate] : changed)
    if (node >= graph_.frozen_nodes) graph_.estimates.edit(node) = estimate;
  take_as_solved(base);
  pass_over(revision);
  compose_from(static_cast<NodeIndex>(count_until(graph_.nodes, base.number)));
}

void MapHead::take_as_solved(const Revision& base) {
  graph_.solved_revision = base;
  graph_.first_unsolved_factor = count_until(graph_.factors, base.number);
  graph_.switched_since_solve = last_switch_ > base.number;
}

void MapHead::compose_from(NodeIndex first) {
  for (NodeIndex node = std::max(first, graph_.frozen_nodes); node < graph_.nodes.size(); ++node) {
    const auto estimate = composed(node);
    if (estimate && *estimate != graph_.estimates[node]) graph_.estimates.edit(node) = *estimate;
  }
}

void MapHead::restore_estimates(std::span<const Estimate> estimates, const Revision& solved) {
  CAIRN_CHECK(estimates.size() == graph_.nodes.size(), "one estimate for each node");
  for (NodeIndex node = 0; node < estimates.size(); ++node)
    graph_.estimates.edit(node) = estimates[node];
  take_as_solved(solved);
}

}  // namespace cairn
