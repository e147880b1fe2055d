// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/replay/graph_transactions.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "cairn/factors/factor_codec.hpp"

namespace cairn {
namespace {

// Sends a graph pose by pose. Every variable has a robot, by number.
class Sender {
 public:
  using NameNode = std::function<NodeId(std::size_t robot, VariableId id)>;

  Sender(const Graph& graph, NameNode name_node, std::vector<std::size_t> robot_of_slot,
         std::size_t robots)
      : graph_(graph),
        name_node_(std::move(name_node)),
        robot_of_slot_(std::move(robot_of_slot)),
        factors_of_(graph.variables().size()),
        sent_(graph.variables().size(), false),
        factor_sent_(graph.factors().size(), false),
        transactions_(robots) {
    for (std::uint32_t f = 0; f < graph.factors().size(); ++f) {
      slots_.push_back(graph.slots_of(graph.factors()[f]));
      for (const VariableSlot slot : slots_[f]) factors_of_[slot].push_back(f);
    }
  }

  std::vector<std::vector<Transaction>> run() {
    for (const VariableSlot pose : in_order(true)) send(pose, true);
    for (const VariableSlot rest : in_order(false)) {
      if (!sent_[rest]) send(rest, false);
    }
    return std::move(transactions_);
  }

 private:
  // Each robot by ids; all robots step by step.
  [[nodiscard]] std::vector<VariableSlot> in_order(bool poses) const {
    std::map<std::size_t, std::vector<VariableSlot>> of_robot;
    const auto variables = graph_.variables();
    for (VariableSlot slot = 0; slot < variables.size(); ++slot) {
      if (is_pose(variables[slot].type) == poses) of_robot[robot_of_slot_[slot]].push_back(slot);
    }
    std::vector<std::tuple<std::size_t, std::size_t, VariableSlot>> steps;
    for (auto& [robot, slots] : of_robot) {
      std::sort(slots.begin(), slots.end(),
                [&](VariableSlot a, VariableSlot b) { return variables[a].id < variables[b].id; });
      for (std::size_t step = 0; step < slots.size(); ++step)
        steps.emplace_back(step, robot, slots[step]);
    }
    std::sort(steps.begin(), steps.end());
    std::vector<VariableSlot> order;
    for (const auto& [step, robot, slot] : steps) order.push_back(slot);
    return order;
  }

  void send(VariableSlot slot, bool with_landmarks) {
    std::vector<Transaction>& of_robot = transactions_[robot_of_slot_[slot]];
    Transaction transaction;
    transaction.key.sequence = of_robot.size() + 1;
    add_variable(slot, transaction);
    if (with_landmarks) {
      for (const std::uint32_t f : factors_of_[slot]) {
        for (const VariableSlot other : slots_[f]) {
          if (sent_[other] || is_pose(graph_.variables()[other].type)) continue;
          robot_of_slot_[other] = robot_of_slot_[slot];
          add_variable(other, transaction);
        }
      }
    }
    for (const std::uint32_t f : factors_of_[slot]) {
      const bool known = std::all_of(slots_[f].begin(), slots_[f].end(),
                                     [&](VariableSlot other) { return sent_[other]; });
      if (known && !factor_sent_[f]) add_factor(f, transaction);
    }
    of_robot.push_back(std::move(transaction));
  }

  [[nodiscard]] NodeId name_of(VariableSlot slot) const {
    return name_node_(robot_of_slot_[slot], graph_.variables()[slot].id);
  }

  void add_variable(VariableSlot slot, Transaction& transaction) {
    sent_[slot] = true;
    NewVariable added;
    added.node = name_of(slot);
    added.type = graph_.variables()[slot].type;
    added.start = describe_value(graph_, slot);
    transaction.variables.push_back(std::move(added));
  }

  void add_factor(std::uint32_t f, Transaction& transaction) {
    factor_sent_[f] = true;
    NewFactor factor = describe_factor(graph_, graph_.factors()[f]);
    for (const VariableSlot slot : slots_[f]) factor.nodes.push_back(name_of(slot));
    transaction.factors.push_back(std::move(factor));
  }

  const Graph& graph_;
  NameNode name_node_;
  std::vector<std::size_t> robot_of_slot_;
  std::vector<std::vector<VariableSlot>> slots_;
  std::vector<std::vector<std::uint32_t>> factors_of_;
  std::vector<bool> sent_, factor_sent_;
  std::vector<std::vector<Transaction>> transactions_;  // by robot
};

}  // namespace

std::vector<Transaction> graph_transactions(const Graph& graph,
                                            const std::function<NodeId(VariableId)>& name_node) {
  const auto name = [&](std::size_t, VariableId id) { return name_node(id); };
  std::vector<std::size_t> all_of_one(graph.variables().size(), 0);
  return std::move(Sender(graph, name, std::move(all_of_one), 1).run().front());
}

std::vector<std::vector<Transaction>> fleet_transactions(
    const Graph& graph, const std::vector<std::string>& robots,
    const std::function<std::size_t(VariableId)>& robot_of) {
  const auto name = [&](std::size_t robot, VariableId id) {
    return NodeId{{robots[robot], 0}, id.value};
  };
  std::vector<std::size_t> robot_of_slot;
  for (const Variable& variable : graph.variables()) robot_of_slot.push_back(robot_of(variable.id));
  return Sender(graph, name, std::move(robot_of_slot), robots.size()).run();
}

}  // namespace cairn
