// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "cairn/core/disjoint_sets.hpp"
#include "cairn/graph/graph.hpp"

namespace cairn {

/// Which parts of a graph only loops tie together, and which of those are tied well enough to be
/// one: within one frame (a robot's odometry epoch) by any loop, frames by several.
class LoopTies {
 public:
  struct Loop {
    std::size_t factor;  ///< place in Graph::factors()
    VariableSlot a, b;
  };
  /// `frames` by slot; empty: robots, the top bytes of ids.
  LoopTies(const Graph& graph, std::vector<Loop> loops, std::size_t least,
           std::vector<std::uint32_t> frames = {});

  /// Two parts become one where enough of the loops that are in tie them at distinct poses, those
  /// with the most first. What is left over ties too little: it goes out of `in`.
  void join(std::vector<bool>& in);
  [[nodiscard]] std::size_t least() const { return least_; }
  /// As of the last join().
  [[nodiscard]] bool joined(std::size_t loop);
  /// At how many poses of one part, or of the other, whichever are fewer, the loops of `among` tie
  /// the same two parts as this one.
  [[nodiscard]] std::size_t places_like(std::size_t loop, const std::vector<bool>& among);

 private:
  [[nodiscard]] std::pair<std::size_t, std::size_t> parts_of(const Loop& loop);
  [[nodiscard]] std::size_t distinct_places(const std::vector<std::size_t>& loops) const;
  [[nodiscard]] bool enough(const std::vector<std::size_t>& loops) const;

  std::vector<std::uint32_t> frames_;
  std::vector<Loop> loops_;
  std::size_t least_;
  DisjointSets parts_;  ///< of slots by everything but the loops; the last one is the map's frame
  DisjointSets joined_;
};

}  // namespace cairn
