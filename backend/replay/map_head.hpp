// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "cairn/graph/pose_graph.hpp"

namespace cairn {

/// Why a transaction cannot be applied, or not yet.
struct Refusal {
  RefusalCode code;
  std::string reason;
  /// A node that is missing and that another source may still add: worth waiting for.
  std::optional<NodeId> awaited{};
};

/// The map after the last record: validates transactions and applies them. One thread.
class MapHead {
 public:
  /// Nothing where apply() would succeed. Looks at the whole transaction before it says yes.
  [[nodiscard]] std::optional<Refusal> check(const Transaction& transaction) const;
  /// Applies what check() let pass.
  void apply(const Transaction& transaction, const Revision& revision);
  /// The same for changes of factors alone, as operators order them.
  [[nodiscard]] std::optional<Refusal> check(std::span<const FactorEdit> edits) const;
  void apply(std::span<const FactorEdit> edits, const Revision& revision);
  /// Takes the estimates of a solve for the nodes that were there at its base, and composes those
  /// that have come since onto them.
  void apply_estimates(std::span<const std::pair<NodeIndex, Estimate>> changed,
                       const Revision& base, const Revision& revision);
  /// Holds the first `nodes` nodes where they are from now on; 0: all may move again.
  void freeze(NodeIndex nodes, const Revision& revision);
  /// The number that the last solve had.
  void set_loops_that_merge(std::size_t loops) { graph_.loops_that_merge = loops; }
  /// The gate's word on a loop closure; nothing happens to one that somebody has switched off.
  void judge(std::size_t factor, FactorState state, const Revision& revision);
  /// Everything that was pending at the base of a solve that asked no gate.
  void commit_loops(const Revision& base);
  /// A record of input that changes neither graph nor estimates.
  void advance(const Revision& revision);
  /// Any other that changes nothing.
  void pass_over(const Revision& revision) { graph_.graph_revision = revision; }
  /// How many loop closures the gate has quarantined.
  [[nodiscard]] std::size_t quarantined() const { return quarantined_; }
  /// The last record that was no solve and no verdict.
  [[nodiscard]] std::uint64_t last_input() const { return last_input_; }
  /// Puts estimates in place of all, as a snapshot of them says; one for each node.
  void restore_estimates(std::span<const Estimate> estimates, const Revision& solved);

  [[nodiscard]] const PoseGraph& graph() const { return graph_; }
  [[nodiscard]] std::optional<NodeIndex> find(const NodeId& node) const;
  /// Its place in graph().factors.
  [[nodiscard]] std::optional<std::size_t> find(const FactorName& factor) const;
  /// Places in graph().factors of those that came with a record: from, and behind the last.
  [[nodiscard]] std::pair<std::size_t, std::size_t> factors_of(std::uint64_t record) const;

  /// Numbers of the records that brought them.
  [[nodiscard]] std::uint64_t record_of_node(NodeIndex node) const {
    return arrivals_[node].number;
  }
  [[nodiscard]] std::uint64_t record_of_factor(std::size_t place) const {
    return record_of_factor_[place];
  }

  /// What would not be in the map had a record never come.
  struct Consequences {
    /// Later records that use nodes of it, directly or through each other; ascending.
    std::vector<std::uint64_t> dependents;
    std::vector<std::size_t> factors;  ///< places of the committed factors of it and of those
    /// A record among them that switches factors itself, or one that switches theirs.
    std::optional<std::uint64_t> edited_by;
  };
  [[nodiscard]] Consequences consequences_of(std::uint64_t record) const;

 private:
  [[nodiscard]] std::optional<Refusal> check_variables(const Transaction& transaction) const;
  [[nodiscard]] std::optional<Refusal> check_factors(const Transaction& transaction) const;
  [[nodiscard]] std::optional<Refusal> check_datum(const Transaction& transaction) const;
  [[nodiscard]] std::optional<VariableType> type_of(const NodeId& node,
                                                    const Transaction& transaction) const;
  [[nodiscard]] std::optional<std::uint32_t> placing_factor(const NewVariable& variable,
                                                            const Transaction& transaction) const;
  [[nodiscard]] std::optional<Estimate> composed(NodeIndex node) const;
  void compose_from(NodeIndex first);
  void note_switch(const Revision& revision);
  void take_as_solved(const Revision& base);
  void set_state(std::size_t factor, FactorState state);
  [[nodiscard]] bool is_own(const NodeId& node, const Transaction& transaction) const;

  // How a node came to be where it is until a solve has seen it.
  struct Arrival {
    std::uint64_t number;  ///< of its record
    std::uint32_t
        placed_by;  ///< place in graph_.factors of the odometry that leads to it; or kNone
  };
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  PoseGraph graph_;
  std::vector<Arrival> arrivals_;                ///< by node
  std::vector<std::uint64_t> record_of_factor_;  ///< by place in graph_.factors; ascending
  std::uint64_t last_input_ = 0;
  std::size_t quarantined_ = 0;
  std::uint64_t last_switch_ = 0;  ///< the last record that switched factors, or froze nodes
  /// By place of a factor, the last record of a transaction that switched it.
  std::map<std::size_t, std::uint64_t> switched_by_;
  std::unordered_map<NodeId, NodeIndex> index_of_node_;
  std::map<TransactionKey, std::size_t> first_factor_of_;  ///< place in graph_.factors
  std::map<std::string, std::string> source_of_robot_;     ///< who first added a node of it
};

}  // namespace cairn
