// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tsl/robin_map.h>

#include <span>
#include <vector>

#include "cairn/io/graph_tags.hpp"

namespace cairn {

/// Finds copies of an edge among files that are merged: robots write the edges between them into
/// both their files.
class CopyFilter {
 public:
  /// True when another text holds an edge with this tag between the same ids, each column of its
  /// measurement within 1e-5. Otherwise remembers the edge.
  bool is_copy(std::size_t text, const TagSpec& tag, std::span<const VariableId> ids,
               std::span<const double> measurement);

 private:
  struct Entry {
    std::size_t text;
    const TagSpec* tag;
    std::size_t measurement;  // in numbers_
    std::size_t older;        // the entry before it with the same ids
  };
  struct Ids {
    VariableId a, b;
    friend bool operator==(const Ids&, const Ids&) = default;
  };
  struct IdsHash {
    std::size_t operator()(const Ids& ids) const {
      return std::hash<VariableId>()(ids.a) * 31 + std::hash<VariableId>()(ids.b);
    }
  };
  static constexpr std::size_t kNone = ~std::size_t{0};

  tsl::robin_map<Ids, std::size_t, IdsHash> newest_;
  std::vector<Entry> entries_;
  std::vector<double> numbers_;
};

}  // namespace cairn
