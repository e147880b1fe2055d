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

}  // namespace cairn
