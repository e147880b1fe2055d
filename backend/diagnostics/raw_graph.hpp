// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tsl/robin_map.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cairn/diagnostics/finding.hpp"
#include "cairn/diagnostics/repairs.hpp"
#include "cairn/io/graph_tags.hpp"
#include "cairn/io/record_scanner.hpp"

namespace cairn {

struct IdHash {
  std::size_t operator()(std::uint64_t id) const noexcept {
    return std::hash<VariableId>()(VariableId{id});
  }
};
template <class Value>
using IdMap = tsl::robin_map<std::uint64_t, Value, IdHash>;

/// A line with a known tag, as written. `broken` lines are kept where their ids can be read, so
/// that one bad number does not make every edge of that vertex look dangling; their numbers must
/// not be used.
struct RawLine {
  const TagSpec* tag = nullptr;
  std::string_view text;   ///< of the whole text; see Record::line
  std::uint32_t line = 0;  ///< from 1
  bool broken = false;     ///< has an error: its numbers are left out of the graph
  CheckCode fault = CheckCode::kNotANumber;  ///< of a broken line
  bool unusable = false;               ///< broken beyond that: not even what it connects is known
  std::array<std::uint64_t, 4> ids{};  ///< variables, then parameters
  std::size_t first_number = 0;        ///< into RawGraph::numbers: measurement, then information
  std::size_t number_count = 0;

  void mark_broken(CheckCode code) { broken = true, fault = code; }
};

/// An id behind FIX.
struct RawFix {
  std::uint64_t id = 0;
  std::uint32_t line = 0;
  Field field{};
  std::string_view text{};  ///< the whole line
  bool broken = false;      ///< left out of the graph
};

/// What the lines of a file say, one by one, before anything is made of it.
struct RawGraph {
  std::string_view text;
  GraphFormat format = GraphFormat::kG2o;
  std::vector<RawLine> lines{};  ///< in the order of the file
  std::vector<double> numbers{};
  std::vector<RawFix> fixes{};
  std::vector<std::string_view>
      rejected{};  ///< lines without readable ids: also left out of the graph

  [[nodiscard]] std::span<const double> measurement(const RawLine& line) const {
    return std::span(numbers).subspan(line.first_number,
                                      static_cast<std::size_t>(line.tag->measurement));
  }
  /// Empty where the line leaves it out.
  [[nodiscard]] std::span<const double> information(const RawLine& line) const {
    const auto skip = static_cast<std::size_t>(line.tag->measurement);
    return std::span(numbers).subspan(line.first_number + skip, line.number_count - skip);
  }
  [[nodiscard]] bool is_edge(const RawLine& line) const { return line.tag->role == TagRole::kEdge; }
  [[nodiscard]] std::span<const std::uint64_t> variables(const RawLine& line) const {
    return std::span(line.ids).first(static_cast<std::size_t>(line.tag->variable_count));
  }
};

/// The field that holds number `n` (counted behind the ids) of a line.
Field number_field(const RawLine& line, std::size_t n);
/// The field that holds id `n`.
Field id_field(const RawLine& line, std::size_t n);

/// Reads the lines one by one; reports tags, counts, numbers and ids that are not what the format
/// says.
RawGraph scan_raw_graph(std::string_view text, GraphFormat format, Findings& findings,
                        Repairs& repairs);

/// "EDGE_SE2 0 1".
std::string describe(const RawLine& line);

}  // namespace cairn
