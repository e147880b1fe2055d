// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "cairn/graph/graph.hpp"

namespace cairn {

/// Gives a value to every variable (by slot) that has no start: poses by chaining relative factors
/// breadth first, from the poses that have a start, and in components without one from the smallest
/// id, which is put at the origin; landmarks from the first factor that tells where they are,
/// otherwise 1 m ahead of the first pose that sees them.
void chain_start_values(Graph& graph, const std::vector<bool>& has_start);

}  // namespace cairn
