// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "cairn/graph/graph.hpp"

namespace cairn {

/// Few relative poses that lead from one end of another one to the other end, and elsewhere than it
/// says.
struct Contradiction {
  std::vector<std::size_t> factors;  ///< places in Graph::factors(), from its first end on
  double chi2 = 0.0;                 ///< of the cycle they make with it, by what all of them state
  double threshold = 0.0;  ///< that it exceeds: the gate's, times the noise scale of its loops
};

/// The smallest set of edges that contradict a relative pose (`edge`, a place in factors()): of all
/// chains of other relative poses between its ends, by ascending number of edges, the first whose
/// cycle with it no gate would believe. Of chains with so many edges that meet at a pose only the
/// one goes on whose covariance has the smallest trace, so a smaller set may exist where that one
/// happens to agree. Nothing where none is found, or `edge` is no relative pose between two poses.
std::optional<Contradiction> find_contradiction(const Graph& graph, std::size_t edge,
                                                const std::function<bool()>& keep_going = {});

}  // namespace cairn
