// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tsl/robin_map.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "cairn/core/ids.hpp"

namespace cairn {

/// From the id of a variable to its position in an array. Small ids, which most graphs have, are
/// looked up in an array, so that neighbors in the graph are neighbors in memory; sparse ids are
/// hashed.
class SlotIndex {
 public:
  void reserve(std::size_t count) {
    if (count > dense_.capacity()) dense_.reserve(count);
  }

  /// False, and nothing changes, when the id is taken.
  bool insert(VariableId id, std::uint32_t slot) {
    if (find(id)) return false;
    ++size_;
    if (id.value >= kDensity * (size_ + kAlwaysDense)) return sparse_.emplace(id, slot).second;
    if (id.value >= dense_.size()) dense_.resize(id.value + 1, kNone);
    dense_[id.value] = slot;
    return true;
  }

  [[nodiscard]] std::optional<std::uint32_t> find(VariableId id) const {
    if (id.value < dense_.size() && dense_[id.value] != kNone) return dense_[id.value];
    if (sparse_.empty()) return std::nullopt;
    const auto found = sparse_.find(id);
    if (found == sparse_.end()) return std::nullopt;
    return found->second;
  }

 private:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  static constexpr std::size_t kDensity = 4;         // at most so many array elements per id
  static constexpr std::size_t kAlwaysDense = 1024;  // and a few more

  std::vector<std::uint32_t> dense_;
  tsl::robin_map<VariableId, std::uint32_t, std::hash<VariableId>> sparse_;
  std::size_t size_ = 0;
};

}  // namespace cairn
