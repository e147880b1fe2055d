// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/graph_source.hpp"

#include <algorithm>

namespace cairn {
namespace {

bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_'; }

}  // namespace

bool looks_like_tag(std::string_view text) {
  constexpr std::size_t kLongest = 64;
  const auto may_follow = [](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || c == ':' || c == '.' || c == '-';
  };
  return text.size() <= kLongest && is_letter(text[0]) &&
         std::all_of(text.begin(), text.end(), may_follow);
}

GraphSource::GraphSource(const NamedText& text, GraphFormat format)
    : name_(text.name), text_(text.text), format_(format), entries_(graph_tags(format).size()) {
  for (const TagSpec& tag : tags()) {
    Entry& entry = entries_[index_of(tag)];
    if (tag.role == TagRole::kEdge) entry.decoder = &edge_decoder(tag);
    entry.has_twin = std::count_if(tags().begin(), tags().end(), [&](const TagSpec& other) {
                       return other.name == tag.name;
                     }) > 1;
  }
}

Result<GraphSource> GraphSource::survey(const NamedText& text, std::optional<GraphFormat> format) {
  if (!format) {
    const Result<GraphFormat> recognized = recognize_graph_format(text.text, text.name);
    if (!recognized) return recognized.error();
    format = *recognized;
  }
  if (*format == GraphFormat::kDlr) {
    return Error{ErrorCode::kUsage, "the dlr format is a folder, not a file", text.name};
  }
  GraphSource source(text, *format);
  if (Result<void> counted = source.count_lines(); !counted) return counted.error();
  if (!source.has_role(TagRole::kVertex) && !source.has_role(TagRole::kEdge)) {
    return Error{ErrorCode::kBadInput,
                 "holds no vertex and no edge in " + std::string(to_string(*format)) + " format",
                 source.place(1)};
  }
  return source;
}

Result<void> GraphSource::count_lines() {
  RecordScanner scanner(text_);
  Record record;
  const TagSpec* tag = nullptr;
  while (scanner.next(record)) {
    if (!tag || record.tag != tag->name) tag = find_tag(format_, record.tag);
    if (tag) {
      ++entries_[index_of(*tag)].lines;
      extents_[static_cast<std::size_t>(tag->role)].add(record);
    } else if (Result<void> kept = keep_unknown(record); !kept) {
      return kept;
    }
  }
  return {};
}

Result<void> GraphSource::keep_unknown(const Record& record) {
  if (!looks_like_tag(record.tag)) {
    return Error{ErrorCode::kBadInput,
                 "'" + quote(record.tag) + "' is not a tag; a line begins with a tag such as " +
                     std::string(tags().front().name),
                 place_in(name_, record.line_number, record.column_of(record.tag.data()))};
  }
  const std::size_t begin = static_cast<std::size_t>(record.line.data() - text_.data());
  std::string_view line = text_.substr(begin, text_.find('\n', begin) - begin);
  while (line.ends_with('\r')) line.remove_suffix(1);
  unknown_lines_.emplace_back(line);
  const auto same =
      std::find_if(unknown_tags_.begin(), unknown_tags_.end(),
                   [&](const UnknownTag& unknown) { return unknown.tag == record.tag; });
  if (same != unknown_tags_.end()) {
    ++same->lines;
    return {};
  }
  constexpr std::size_t kMaxTags = 100;  // kinds of lines nobody knows: more is not a graph file
  if (unknown_tags_.size() == kMaxTags) {
    return Error{ErrorCode::kBadInput, "more than 100 unknown tags; this is not a graph file",
                 place(record.line_number)};
  }
  unknown_tags_.push_back({std::string(record.tag), record.line_number, 1});
  return {};
}

Result<void> GraphSource::read(const Record& record, const TagSpec& tag, LineFields& fields) const {
  const auto all = static_cast<std::size_t>(tag.measurement + tag.information_columns());
  const auto required = tag.information_optional ? static_cast<std::size_t>(tag.measurement) : all;
  const auto read = read_fields(
      record, name_, std::span(fields.ids).first(static_cast<std::size_t>(tag.id_columns())),
      std::span(fields.numbers).first(all), required);
  if (!read) return read.error();
  fields.number_count = static_cast<int>(*read);
  return {};
}

Error GraphSource::error_at(const Record& record, int field, std::string message) const {
  const auto found = field_at(record, static_cast<std::size_t>(field));
  return {ErrorCode::kBadInput, std::move(message),
          place_in(name_, record.line_number, found ? found->column : 1)};
}

}  // namespace cairn
