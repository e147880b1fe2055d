// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <set>
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
  /// The gate's word on a loop closure; nothing happens to one that somebody has switched off, or
  /// trusts.
  void judge(std::size_t factor, FactorState state, const Revision& revision);
  /// Everything that was pending at the base of a solve that asked no gate.
  void commit_loops(const Revision& base);
  /// A record of input that changes neither graph nor estimates.
  void advance(const Revision& revision);
  /// Any other that changes nothing.
  void pass_over(const Revision& revision) { graph_.graph_revision = revision; }
  /// How many loop closures the gate has quarantined, by source; of the others there are none.
  [[nodiscard]] const std::map<std::string, std::size_t>& quarantined() const {
    return quarantined_;
  }
  /// The last record that was no solve and no verdict.
  [[nodiscard]] std::uint64_t last_input() const { return last_input_; }
  /// Puts estimates in place of all, as a snapshot of them says; one for each node.
  void restore_estimates(std::span<const Estimate> estimates, const Revision& solved);

  [[nodiscard]] const PoseGraph& graph() const { return graph_; }
  [[nodiscard]] std::optional<NodeIndex> find(const NodeId& node) const;
  /// Its place in graph().factors.
  [[nodiscard]] std::optional<std::size_t> find(const FactorName& factor) const;
  /// Those with what a source sent and was accepted; ascending.
  [[nodiscard]] std::span<const std::uint64_t> records_of(const std::string& source) const;

  /// What would not be in the map had some records never come.
  struct Consequences {
    /// Other records that use nodes of them, directly or through each other; ascending.
    std::vector<std::uint64_t> dependents;
    std::vector<std::size_t> factors;  ///< places of the enabled factors of them and of those
    /// A record among them that switches factors itself, or one that switches theirs.
    std::optional<std::uint64_t> edited_by;
  };
  [[nodiscard]] Consequences consequences_of(const std::set<std::uint64_t>& records) const;

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
  void note_payloads(std::span<const ContentHash> payloads, std::span<const NodeIndex> nodes);
  void note_switch(const Revision& revision);
  void take_as_solved(const Revision& base);
  void set_state(std::size_t factor, FactorState state);
  [[nodiscard]] bool is_own(const NodeId& node, const Transaction& transaction) const;

  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  PoseGraph graph_;
  /// By node, the place in graph_.factors of the odometry that leads to it; or kNone. There it is
  /// until a solve has seen it.
  std::vector<std::uint32_t> placed_by_;
  std::uint64_t last_input_ = 0;
  std::map<std::string, std::size_t> quarantined_;                ///< by source
  std::map<std::string, std::vector<std::uint64_t>> records_of_;  ///< by source
  std::uint64_t last_switch_ = 0;  ///< the last record that switched factors, or froze nodes
  /// By place of a factor, the last record of a transaction that switched it.
  std::map<std::size_t, std::uint64_t> switched_by_;
  std::set<std::uint64_t> editing_;  ///< records of transactions that switched factors
  std::unordered_map<NodeId, NodeIndex> index_of_node_;
  std::map<TransactionKey, std::size_t> first_factor_of_;  ///< place in graph_.factors
  std::map<std::string, std::string> source_of_robot_;     ///< who first added a node of it
};

}  // namespace cairn
