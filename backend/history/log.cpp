// SPDX-License-Identifier: BSD-3-Clause
// log and show: what the journal holds, record by record.
#include <algorithm>

#include "cairn/history/question.hpp"
#include "cairn/history/record_json.hpp"

namespace cairn {
namespace {

using Json = nlohmann::ordered_json;

struct Filter {
  std::string source, kind;

  [[nodiscard]] bool fits(const Record& record) const {
    if (!source.empty()) {
      const TransactionKey* key = key_of(record);
      if (key == nullptr || key->source != source) return false;
    }
    return kind.empty() || kind == kind_of(record);
  }
};

std::string source_of(const Record& record) {
  const TransactionKey* key = key_of(record);
  return key == nullptr ? "-" : key->source + '/' + std::to_string(key->sequence);
}

std::string line_of(const Record& record) {
  const auto time = time_of(record);
  char start[64];
  std::snprintf(start, sizeof start, "%9llu  %-24s  %-11s  ",
                static_cast<unsigned long long>(record.number), time ? to_utc(*time).c_str() : "-",
                kind_of(record).c_str());
  std::string source = source_of(record);
  source.resize(std::max<std::size_t>(source.size(), 16), ' ');
  return start + source + "  " + summarize(record);
}

std::string json_line_of(const Record& record) {
  Json json{{"number", record.number}, {"era", record.era}};
  const auto time = time_of(record);
  json["time"] = time ? Json(to_utc(*time)) : Json();
  json["kind"] = kind_of(record);
  const TransactionKey* key = key_of(record);
  json["source"] = key ? Json(key->source) : Json();
  json["sequence"] = key ? Json(key->sequence) : Json();
  json["what"] = summarize(record);
  return dump(json, -1);
}

Result<void> check_range(std::uint64_t from, std::uint64_t to, std::uint64_t newest) {
  if (from == 0 || from > to)
    return Error{ErrorCode::kUsage, "there is no range of records from " + std::to_string(from) +
                                        " to " + std::to_string(to) + "; the newest is " +
                                        std::to_string(newest)};
  return {};
}

// JSON as indented lines, for people.
void append_lines(const Json& json, std::size_t indent, std::string& text) {
  for (const auto& [name, value] : json.items()) {
    const bool in_list = json.is_array();
    text.append(indent, ' ') += in_list ? "- " : name + ": ";
    const bool nested = !value.empty() && value.is_structured() &&
                        (value.is_object() || value.front().is_structured());
    if (!nested) {
      text += (value.is_string() ? value.get<std::string>() : dump(value, -1)) + '\n';
      continue;
    }
    if (!in_list) text += '\n';
    std::string inner;
    append_lines(value, indent + 2, inner);
    text += in_list ? inner.substr(indent + 2) : inner;
  }
}

}  // namespace

Result<std::string> answer_log(const Question& question, const Asked& asked) {
  const auto known = question.check_options({"from", "to", "source", "kind", "limit", "json"});
  if (!known) return known.error();
  const std::uint64_t newest = asked.journal.head().revision.number;
  if (newest == 0) return std::string();
  const std::uint64_t from = question.number("from", 1);
  const std::uint64_t to = std::min(question.number("to", newest), newest);
  if (auto range = check_range(from, to, newest); !range) return range.error();
  const std::uint64_t limit = question.number("limit", 0);
  const Filter filter{question.text("source"), question.text("kind")};
  // The newest ones that fit; backwards, so that they are found at once in a long journal.
  std::vector<std::string> lines;
  for (std::uint64_t number = to; number >= from && (limit == 0 || lines.size() < limit);
       --number) {
    if (asked.keep_going && !asked.keep_going()) return Error{ErrorCode::kInternal, "interrupted"};
    const Result<Record> record = asked.journal.read(number);
    if (!record) return record.error();
    if (filter.fits(*record))
      lines.push_back(question.flag("json") ? json_line_of(*record) : line_of(*record));
  }
  std::string text;
  for (auto line = lines.rbegin(); line != lines.rend(); ++line) text += *line + '\n';
  return text;
}

Result<std::string> answer_show(const Question& question, const Asked& asked) {
  if (const auto known = question.check_options({"number", "json"}); !known) return known.error();
  const Result<Record> record = find_record(asked.journal, question.number("number", 0));
  if (!record) return record.error();
  const Json json = to_json(*record);
  if (question.flag("json")) return dump(json) + '\n';
  std::string text;
  append_lines(json, 0, text);
  return text;
}

}  // namespace cairn
