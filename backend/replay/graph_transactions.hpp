// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cairn/graph/graph.hpp"
#include "cairn/graph/transaction.hpp"

namespace cairn {

/// A graph as a live front-end would have sent it: one transaction per pose in the order of ids,
/// with the landmarks it is the first to see and every factor whose nodes are known by then.
/// `name_node` says what a variable is called. Keys have sequences 1, 2, ...; source and epoch are
/// the caller's.
std::vector<Transaction> graph_transactions(const Graph& graph,
                                            const std::function<NodeId(VariableId)>& name_node);

/// The same for several robots whose measurements tie to each other: the transactions of each one.
/// `robot_of` names the robot of a pose, and of a landmark that no pose sees; a landmark is a node
/// of the robot that sees it first. A factor between robots is sent by the one that comes to it
/// last when all go at the same pace, so that no two ever wait for each other. Nodes are
/// (robots[i], epoch 0, id).
std::vector<std::vector<Transaction>> fleet_transactions(
    const Graph& graph, const std::vector<std::string>& robots,
    const std::function<std::size_t(VariableId)>& robot_of);

}  // namespace cairn
