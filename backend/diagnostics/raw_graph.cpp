// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/raw_graph.hpp"

#include <algorithm>
#include <cctype>
#include <numeric>

#include "cairn/diagnostics/line_repairs.hpp"
#include "cairn/io/graph_source.hpp"

namespace cairn {
namespace {

using TypeOfId = IdMap<VariableType>;

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

// Levenshtein distance; both texts are tags, so at most some forty bytes.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t kept = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({kept, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row[b.size()];
}

std::string unknown_tag_hint(std::string_view tag, GraphFormat format) {
  for (const GraphFormat other : {GraphFormat::kG2o, GraphFormat::kToro, GraphFormat::kIsam}) {
    if (other != format && find_tag(other, tag)) {
      return "it is a tag of the " + std::string(to_string(other)) +
             " format; keep to one format per file";
    }
  }
  constexpr std::size_t kLongestTag = 40, kFarthest = 3;
  if (tag.size() > kLongestTag) return {};
  const std::string lower = lower_case(tag);
  std::size_t best = kFarthest + 1;
  std::string_view nearest;
  for (const TagSpec& known : graph_tags(format)) {
    const std::size_t distance = edit_distance(lower, lower_case(known.name));
    if (distance < best) best = distance, nearest = known.name;
  }
  if (nearest.empty()) return "the line is kept as it is, and takes no part in the graph";
  return "did you mean " + std::string(nearest) + "? As it is, the line takes no part in the graph";
}

class Scanner {
 public:
  Scanner(RawGraph& graph, Findings& findings, Repairs& repairs)
      : graph_(graph),
        findings_(findings),
        repairs_(repairs),
        commas_(find_comma_style(graph.text)) {}

  void run() {
    collect_types();
    RecordScanner scanner(graph_.text);
    Record record;
    while (scanner.next(record)) scan_line(record);
  }

 private:
  // What the vertices are decides how the lines of some tags of ours are to be read.
  void collect_types() {
    RecordScanner scanner(graph_.text);
    Record record;
    while (scanner.next(record)) {
      const TagSpec* tag = find_tag(graph_.format, record.tag);
      if (!tag || tag->role != TagRole::kVertex) continue;
      std::uint64_t id;
      const auto field = FieldCursor(record).next();
      if (field && parse_id(field->text, id) == NumberFault::kNone)
        types_.emplace(id, tag->variables[0]);
    }
  }

  void scan_line(const Record& record) {
    const TagSpec* tag = find_tag(graph_.format, record.tag);
    if (!tag) return report_unknown(record);
    if (tag->role == TagRole::kFix) return scan_fix(record);
    RawLine line{
        .tag = tag, .text = record.line, .line = static_cast<std::uint32_t>(record.line_number)};
    if (!scan_ids(record, line)) {
      graph_.rejected.push_back(record.line);
      return;
    }
    line.tag = &variant(line, count_fields(record));
    line.first_number = graph_.numbers.size();
    scan_count(record, line);
    if (!line.broken) scan_numbers(record, line);
    graph_.lines.push_back(line);
  }

  void report_unknown(const Record& record) {
    const std::size_t column = record.column_of(record.tag.data());
    if (!looks_like_tag(record.tag)) {
      graph_.rejected.push_back(record.line);
      findings_.add(CheckCode::kNotATag, record.line_number, column,
                    "'" + quote(record.tag) + "' is not a tag: a line begins with a tag such as " +
                        std::string(graph_tags(graph_.format)[0].name),
                    "put # before lines that are not meant to be read");
      return;
    }
    findings_.add(CheckCode::kUnknownTag, record.line_number, column,
                  "'" + quote(record.tag) + "' is not a tag of the " +
                      std::string(to_string(graph_.format)) + " format",
                  unknown_tag_hint(record.tag, graph_.format));
  }

  void scan_fix(const Record& record) {
    FieldCursor fields(record);
    bool any = false;
    while (const auto field = fields.next()) {
      any = true;
      RawFix fix{.line = static_cast<std::uint32_t>(record.line_number),
                 .field = *field,
                 .text = record.line};
      fix.broken = parse_id(field->text, fix.id) != NumberFault::kNone;
      if (fix.broken) report_id(record, *field);
      graph_.fixes.push_back(fix);
    }
    if (any) return;
    findings_.add(CheckCode::kWrongCount, record.line_number, 1,
                  "FIX expects one or more vertex ids, found none",
                  "name the vertices to hold, or delete the line");
    graph_.rejected.push_back(record.line);
  }

  bool scan_ids(const Record& record, RawLine& line) {
    FieldCursor fields(record);
    for (int k = 0; k < line.tag->id_columns(); ++k) {
      const auto field = fields.next();
      if (!field) {
        report_count(record, *line.tag, count_fields(record));
        return false;
      }
      if (parse_id(field->text, line.ids[static_cast<std::size_t>(k)]) == NumberFault::kNone)
        continue;
      report_id(record, *field);
      return false;
    }
    return true;
  }

  // Tags with two meanings: by the type of the first vertex, else by the number of columns.
  const TagSpec& variant(const RawLine& line, std::size_t columns) const {
    const auto type = types_.find(line.ids[0]);
    if (type != types_.end()) return variant_for(graph_.format, *line.tag, type->second);
    for (const TagSpec& other : graph_tags(graph_.format)) {
      if (other.name == line.tag->name && static_cast<std::size_t>(other.columns()) == columns)
        return other;
    }
    return *line.tag;
  }

  void scan_count(const Record& record, RawLine& line) {
    const std::size_t found = count_fields(record);
    const TagSpec& tag = *line.tag;
    const auto bare = static_cast<std::size_t>(tag.id_columns() + tag.measurement);
    line.broken = found != static_cast<std::size_t>(tag.columns()) &&
                  !(tag.information_optional && found == bare);
    if (!line.broken) return;
    line.mark_broken(CheckCode::kWrongCount);
    report_count(record, tag, found);
    repair_full_matrix(record, tag, found, repairs_);
  }

  void scan_numbers(const Record& record, RawLine& line) {
    FieldCursor fields(record);
    for (int k = 0; k < line.tag->id_columns(); ++k) fields.next();
    bool not_finite = false;
    while (const auto field = fields.next()) {
      double number = 0.0;
      const NumberFault fault = parse_number(field->text, number);
      graph_.numbers.push_back(number);
      ++line.number_count;
      if (fault == NumberFault::kNone) continue;
      not_finite |= fault == NumberFault::kNotFinite || fault == NumberFault::kOutOfRange;
      line.mark_broken(not_finite ? CheckCode::kNotFinite : CheckCode::kNotANumber);
      report_number(record, *field, fault);
    }
    if (!line.broken) return;
    repair_decimal_commas(record, commas_, repairs_);
    // A vertex is given a value from its edges later on; an edge without a measurement says
    // nothing.
    if (not_finite && line.tag->role == TagRole::kEdge) {
      repairs_.drop(CheckCode::kNotFinite, line.line, line.text,
                    "dropped " + describe(line) + ": not finite");
    }
  }

  void report_id(const Record& record, const Field& field) {
    std::string hint = "ids are whole numbers";
    if (!field.text.empty() && field.text[0] == '-') hint = "renumber the vertices from 0 up";
    if (field.text.find('.') != std::string_view::npos)
      hint = "write the id without a decimal point";
    findings_.add(CheckCode::kBadId, record.line_number, field.column,
                  describe_id_fault(field.text), hint);
  }

  void report_number(const Record& record, const Field& field, NumberFault fault) {
    CheckCode code = CheckCode::kNotANumber;
    std::string hint = "expected a decimal number such as -1.5e-3";
    if (fault == NumberFault::kNotFinite || fault == NumberFault::kOutOfRange) {
      code = CheckCode::kNotFinite;
      hint =
          "find out where the program that wrote it divides by zero; --fix drops such edges, and "
          "puts such "
          "vertices where their edges say";
    } else if (fault == NumberFault::kDecimalComma) {
      code = CheckCode::kDecimalComma;
      hint = commas_ == CommaStyle::kDecimal ? "--fix writes points"
                                             : "1,234 may also mean 1234: write it without comma";
    } else if (field.text.find(',') != std::string_view::npos) {
      hint = "separate columns by blanks, not by commas";
    }
    findings_.add(code, record.line_number, field.column, describe_number_fault(fault, field.text),
                  hint);
  }

  void report_count(const Record& record, const TagSpec& tag, std::size_t found) {
    std::string message = std::string(tag.name) + " expects " + std::to_string(tag.columns()) +
                          " numbers (" + std::to_string(tag.id_columns()) + " ids";
    if (tag.measurement > 0)
      message += ", " + std::to_string(tag.measurement) + " for " + std::string(tag.what);
    if (tag.information > 0)
      message += ", " + std::to_string(tag.information_columns()) + " information";
    message += "), found " + std::to_string(found);
    findings_.add(CheckCode::kWrongCount, record.line_number, record.column_of(record.tag.data()),
                  std::move(message), count_hint(record, tag, found));
  }

  std::string count_hint(const Record& record, const TagSpec& tag, std::size_t found) const {
    const char* end = record.line.data() + record.line.size();
    const auto rest = static_cast<std::size_t>(graph_.text.data() + graph_.text.size() - end);
    if (rest == 0 && found < static_cast<std::size_t>(tag.columns())) {
      return "the file ends in the middle of this line: it is cut off; copy or write it again";
    }
    const auto bare = static_cast<std::size_t>(tag.id_columns() + tag.measurement);
    const auto n = static_cast<std::size_t>(tag.information);
    if (n > 1 && found == bare + n * n) {
      return "looks like the whole information matrix: write its upper triangle, row by row";
    }
    if (n > 0 && found == bare) return "the information is missing";
    if (n > 1 && found == bare + n) {
      return "looks like the diagonal of the information: write the upper triangle, zeros included";
    }
    return {};
  }

  RawGraph& graph_;
  Findings& findings_;
  Repairs& repairs_;
  CommaStyle commas_;
  TypeOfId types_;
};

}  // namespace

Field id_field(const RawLine& line, std::size_t n) {
  const Record record{.line = line.text,
                      .line_number = line.line,
                      .tag = line.text.substr(0, line.text.find_first_of(" \t"))};
  Record behind = record;
  const std::size_t start = line.text.find(line.tag->name);
  behind.tag = line.text.substr(start, line.tag->name.size());
  FieldCursor fields(behind);
  std::optional<Field> field = fields.next();
  for (std::size_t k = 0; k < n && field; ++k) field = fields.next();
  return field.value_or(Field{line.text, 1});
}

Field number_field(const RawLine& line, std::size_t n) {
  return id_field(line, static_cast<std::size_t>(line.tag->id_columns()) + n);
}

RawGraph scan_raw_graph(std::string_view text, GraphFormat format, Findings& findings,
                        Repairs& repairs) {
  RawGraph graph{.text = text, .format = format};
  Scanner(graph, findings, repairs).run();
  return graph;
}

std::string describe(const RawLine& line) {
  std::string text(line.tag->name);
  for (int k = 0; k < line.tag->variable_count; ++k) text += ' ' + std::to_string(line.ids[k]);
  return text;
}

}  // namespace cairn
