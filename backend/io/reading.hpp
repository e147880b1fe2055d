// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

#include "cairn/io/equivalence.hpp"
#include "cairn/io/graph_source.hpp"

namespace cairn {

/// What the parts of the graph reader share while they read. Parts run one after the other over all
/// sources, so that lines may stand in any order: names first, then vertices, then edges.
struct Reading {
  ReadOptions options;
  std::vector<GraphSource> sources;
  GraphDocument document;
  Equivalence equivalence;
  /// Whether a robot (the id's top byte) has a VERTEX line of a type. All vertices of one type and
  /// robot may be left out together; a single one is an error.
  std::array<std::array<bool, 256>, 4> has_vertices{};

  [[nodiscard]] bool may_be_left_out(VariableId id, VariableType type) const {
    return !has_vertices[static_cast<std::size_t>(type)][id.value >> 56];
  }
  /// Notes a warning, or returns it as an error where warnings are errors.
  Result<void> warn(std::string place, std::string message);
};

/// Refuses quaternions without direction.
Result<void> check_quaternion(const GraphSource& source, const Record& record, const TagSpec& tag,
                              const LineFields& fields);

/// Reads the VERTEX lines. Of several ids of one variable (EQUIV) the root's line counts, and of
/// several files the first.
Result<void> read_vertices(Reading& reading);

/// Reads the edges, and adds the variables that only edges mention.
Result<void> read_edges(Reading& reading);

/// The entry of an edge tag that fits the variables, where there are two (graph_tags.hpp). Null
/// when neither the variables nor the number of columns tell.
const TagSpec* fitting_tag(const GraphSource& source, const Record& record, const TagSpec& tag,
                           const std::optional<VariableType>& first);

/// The id in a field behind the tag, if there is one.
std::optional<VariableId> find_id(const Record& record, int field);

/// Adds the variables that the edges mention and no VERTEX line defines, sorted by id, as far as
/// they may be left out.
Result<void> add_missing_variables(Reading& reading);

}  // namespace cairn
