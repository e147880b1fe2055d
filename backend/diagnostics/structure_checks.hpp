// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/diagnostics/raw_graph.hpp"

namespace cairn {

/// What the lines refer to.
struct RawStructure {
  struct Vertex {
    VariableType type;
    std::uint32_t line = 0;  ///< of its definition; 0 where only edges name it
    std::uint32_t edges = 0;
    std::uint32_t first_edge = 0;  ///< line of the first edge that names it
    bool broken = false;           ///< its line has an error
  };
  IdMap<Vertex> vertices;  ///< every id a line defines or an edge names
  std::vector<std::uint64_t>
      dangling;  ///< ids that edges name and a line should define, in file order

  /// Where to point for a variable: its own line, else its first edge.
  [[nodiscard]] std::uint32_t line_of(std::uint64_t id) const;
};

/// Looks at lines against each other: vertices defined twice, edges to themselves, repeated or
/// dangling, types, sensor offsets, FIX. Lines the readers refuse become `broken`.
RawStructure check_structure(RawGraph& graph, Findings& findings, Repairs& repairs);

}  // namespace cairn
