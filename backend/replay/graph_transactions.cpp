// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/replay/graph_transactions.hpp"

#include <algorithm>

#include "cairn/factors/factor_codec.hpp"

namespace cairn {
namespace {

class Sender {
 public:
  Sender(const Graph& graph, const std::function<NodeId(VariableId)>& name_node)
      : graph_(graph),
        name_node_(name_node),
        factors_of_(graph.variables().size()),
        sent_(graph.variables().size(), false),
        factor_sent_(graph.factors().size(), false) {
    for (std::uint32_t f = 0; f < graph.factors().size(); ++f) {
      slots_.push_back(graph.slots_of(graph.factors()[f]));
      for (const VariableSlot slot : slots_[f]) factors_of_[slot].push_back(f);
    }
  }

  std::vector<Transaction> run() {
    for (const VariableSlot pose : in_order_of_ids(true)) send(pose, true);
    for (const VariableSlot rest : in_order_of_ids(false)) {
      if (!sent_[rest]) send(rest, false);
    }
    return std::move(transactions_);
  }

 private:
  std::vector<VariableSlot> in_order_of_ids(bool poses) const {
    std::vector<VariableSlot> order;
    const auto variables = graph_.variables();
    for (VariableSlot slot = 0; slot < variables.size(); ++slot) {
      if (is_pose(variables[slot].type) == poses) order.push_back(slot);
    }
    std::sort(order.begin(), order.end(),
              [&](VariableSlot a, VariableSlot b) { return variables[a].id < variables[b].id; });
    return order;
  }

  void send(VariableSlot slot, bool with_landmarks) {
    Transaction transaction;
    transaction.key.sequence = transactions_.size() + 1;
    add_variable(slot, transaction);
    if (with_landmarks) {
      for (const std::uint32_t f : factors_of_[slot]) {
        for (const VariableSlot other : slots_[f]) {
          if (!sent_[other] && !is_pose(graph_.variables()[other].type))
            add_variable(other, transaction);
        }
      }
    }
    for (const std::uint32_t f : factors_of_[slot]) {
      const bool known = std::all_of(slots_[f].begin(), slots_[f].end(),
                                     [&](VariableSlot other) { return sent_[other]; });
      if (known && !factor_sent_[f]) add_factor(f, transaction);
    }
    transactions_.push_back(std::move(transaction));
  }

  void add_variable(VariableSlot slot, Transaction& transaction) {
    sent_[slot] = true;
    const Variable& variable = graph_.variables()[slot];
    NewVariable added;
    added.node = name_node_(variable.id);
    added.type = variable.type;
    added.start = describe_value(graph_, slot);
    transaction.variables.push_back(std::move(added));
  }

  void add_factor(std::uint32_t f, Transaction& transaction) {
    factor_sent_[f] = true;
    NewFactor factor = describe_factor(graph_, graph_.factors()[f]);
    for (const VariableSlot slot : slots_[f])
      factor.nodes.push_back(name_node_(graph_.variables()[slot].id));
    transaction.factors.push_back(std::move(factor));
  }

  const Graph& graph_;
  const std::function<NodeId(VariableId)>& name_node_;
  std::vector<std::vector<VariableSlot>> slots_;
  std::vector<std::vector<std::uint32_t>> factors_of_;
  std::vector<bool> sent_, factor_sent_;
  std::vector<Transaction> transactions_;
};

}  // namespace

std::vector<Transaction> graph_transactions(const Graph& graph,
                                            const std::function<NodeId(VariableId)>& name_node) {
  return Sender(graph, name_node).run();
}

}  // namespace cairn
