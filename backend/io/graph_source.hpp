// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

#include "cairn/io/edge_decoder.hpp"
#include "cairn/io/graph_reader.hpp"
#include "cairn/io/record_scanner.hpp"

namespace cairn {

/// What begins a line we keep without understanding it; anything else is not a graph file.
bool looks_like_tag(std::string_view text);

/// The columns of one line, parsed. The largest line has 2 + 2 ids and 7 + 21 numbers.
struct LineFields {
  std::array<std::uint64_t, 4> ids;
  std::array<double, 42> numbers;
  int number_count = 0;
};

/// A text with its format, and what its survey found: how often each tag occurs, and the lines
/// whose tag nobody knows.
class GraphSource {
 public:
  struct UnknownTag {
    std::string tag;
    std::size_t first_line;
    std::size_t lines;
  };

  /// Recognizes the format and counts the tags. Fails on text that is no graph file.
  static Result<GraphSource> survey(const NamedText& text, std::optional<GraphFormat> format);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] GraphFormat format() const { return format_; }
  [[nodiscard]] std::span<const TagSpec> tags() const { return graph_tags(format_); }
  [[nodiscard]] std::size_t count(const TagSpec& tag) const {
    return entries_[index_of(tag)].lines;
  }
  [[nodiscard]] const EdgeDecoder& decoder(const TagSpec& tag) const {
    return *entries_[index_of(tag)].decoder;
  }
  /// Whether the tag has another entry, for poses in another space.
  [[nodiscard]] bool has_twin(const TagSpec& tag) const { return entries_[index_of(tag)].has_twin; }
  [[nodiscard]] const std::vector<UnknownTag>& unknown_tags() const { return unknown_tags_; }
  [[nodiscard]] const std::vector<std::string>& unknown_lines() const { return unknown_lines_; }

  /// Calls visit(record, tag) -> Result<void> for every line of a role, in file order, until one
  /// fails.
  template <class Visit>
  Result<void> for_each(TagRole role, Visit visit) const {
    if (!has_role(role)) return {};
    const Extent& part = extent(role);
    RecordScanner scanner(part.text, ' ', part.first_line);
    Record record;
    const TagSpec* tag = nullptr;
    while (scanner.next(record)) {
      if (!tag || record.tag != tag->name) tag = find_tag(format_, record.tag);
      if (!tag || tag->role != role) continue;
      if (Result<void> visited = visit(record, *tag); !visited) return visited;
    }
    return {};
  }

  /// Parses a line by its tag. Information that may be left out is.
  Result<void> read(const Record& record, const TagSpec& tag, LineFields& fields) const;

  /// An error at the index-th field behind the tag.
  [[nodiscard]] Error error_at(const Record& record, int field, std::string message) const;
  [[nodiscard]] std::string place(std::size_t line) const { return place_in(name_, line, 1); }

 private:
  struct Entry {
    std::size_t lines = 0;
    const EdgeDecoder* decoder = nullptr;
    bool has_twin = false;
  };

  /// Where the lines of a role are, from the first to the last: often they stand together.
  struct Extent {
    std::string_view text{};
    std::size_t first_line = 0;

    void add(const Record& record) {
      const char* begin = text.empty() ? record.line.data() : text.data();
      if (text.empty()) first_line = record.line_number;
      text = {begin, record.line.data() + record.line.size()};
    }
  };

  GraphSource(const NamedText& text, GraphFormat format);
  [[nodiscard]] std::size_t index_of(const TagSpec& tag) const {
    return static_cast<std::size_t>(&tag - graph_tags(format_).data());
  }
  [[nodiscard]] const Extent& extent(TagRole role) const {
    return extents_[static_cast<std::size_t>(role)];
  }
  [[nodiscard]] bool has_role(TagRole role) const { return !extent(role).text.empty(); }
  Result<void> count_lines();
  Result<void> keep_unknown(const Record& record);

  std::string name_;
  std::string_view text_;
  GraphFormat format_;
  std::array<Extent, 5> extents_;  // by role
  std::vector<Entry> entries_;     // parallel to tags(); a twin counts with the first of its name
  std::vector<UnknownTag> unknown_tags_;
  std::vector<std::string> unknown_lines_;
};

}  // namespace cairn
