// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/linear/elimination_cache.hpp"

#include <algorithm>
#include <utility>

namespace cairn {
namespace {

constexpr std::size_t kRemembered =
    4;  // patterns: of a live map and its settled one, and two spare

}  // namespace

Elimination EliminationCache::find(const BlockGraph& graph) {
  const auto found = std::find_if(known_.begin(), known_.end(), [&](const Known& known) {
    return known.graph.begin == graph.begin && known.graph.neighbors == graph.neighbors;
  });
  if (found != known_.end()) {
    ++hits_;
    std::rotate(known_.begin(), found, found + 1);
    return known_.front().elimination;
  }
  ++misses_;
  known_.push_front({graph, find_elimination(graph)});
  if (known_.size() > kRemembered) known_.pop_back();
  return known_.front().elimination;
}

}  // namespace cairn
