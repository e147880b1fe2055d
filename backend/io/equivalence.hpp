// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tsl/robin_map.h>

#include "cairn/core/ids.hpp"

namespace cairn {

/// Which ids name one variable (EQUIV lines).
class Equivalence {
 public:
  /// b becomes another name of what a names.
  void merge(VariableId a, VariableId b) {
    const VariableId root_a = root(a), root_b = root(b);
    if (root_a != root_b) parent_[root_b] = root_a;
  }
  /// The id that all its names lead to; most ids have no other.
  [[nodiscard]] VariableId root(VariableId id) const {
    if (parent_.empty()) return id;
    VariableId end = id;
    for (auto up = parent_.find(end); up != parent_.end(); up = parent_.find(end)) end = up->second;
    while (id != end) {  // every name on the way leads there at once from now on
      const VariableId up = parent_[id];
      parent_[id] = end;
      id = up;
    }
    return end;
  }

 private:
  mutable tsl::robin_map<VariableId, VariableId, std::hash<VariableId>> parent_;
};

}  // namespace cairn
