// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>

#include "cairn/linear/elimination.hpp"

namespace cairn {

/// find_elimination() that remembers the last few patterns: solves that follow each other on the
/// same pattern order and analyze it once. The answer is the same with and without. One thread.
class EliminationCache {
 public:
  /// By value: the cache may forget it.
  Elimination find(const BlockGraph& graph);

  [[nodiscard]] std::uint64_t hits() const { return hits_; }
  [[nodiscard]] std::uint64_t misses() const { return misses_; }

 private:
  struct Known {
    BlockGraph graph;
    Elimination elimination;
  };

  std::deque<Known> known_;  ///< the one asked for last is first
  std::uint64_t hits_ = 0, misses_ = 0;
};

}  // namespace cairn
