// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>

#include "cairn/graph/graph.hpp"

namespace cairn {

/// Loop closures as a front-end that confuses places reports them: what was measured between two
/// poses, said of two others.
struct FalseLoopOptions {
  std::size_t count = 100;
  /// The last so many of them come in runs of four keyframes in a row that agree with each other.
  std::size_t in_groups = 0;
  /// True: between two robots (top bytes of ids). False: of one, at least 40 keyframes apart.
  bool between_robots = false;
  double least_off_m = 3.0;  ///< from where the solved graph has the second pose
  std::uint64_t seed = 1;
};

/// Adds false copies of its loops to a graph of poses of one type with loops of type F (BetweenSe2
/// or BetweenSe3) and a chain of odometry per robot, in the order of ids. `solved`: the same graph
/// without them, at its optimum. Returns their places in Graph::factors(): all that it found in
/// 1000 draws for each.
template <class F>
std::set<std::size_t> add_false_loops(Graph& graph, const Graph& solved,
                                      const FalseLoopOptions& options);

}  // namespace cairn
