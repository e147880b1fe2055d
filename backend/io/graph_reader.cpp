// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/graph_reader.hpp"

#include <algorithm>
#include <cmath>

#include "cairn/io/reading.hpp"
#include "cairn/io/start_values.hpp"

namespace cairn {

Result<void> Reading::warn(std::string place, std::string message) {
  if (options.strict) return Error{ErrorCode::kBadInput, std::move(message), std::move(place)};
  document.warnings.push_back(std::move(place) + ": " + message);
  return {};
}

Result<void> check_quaternion(const GraphSource& source, const Record& record, const TagSpec& tag,
                              const LineFields& fields) {
  if (tag.quaternion < 0) return {};
  const auto q = std::span(fields.numbers).subspan(static_cast<std::size_t>(tag.quaternion), 4);
  const double squared_length = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  if (squared_length > 1e-12 && squared_length < 1e12) return {};
  return source.error_at(record, tag.id_columns() + tag.quaternion,
                         "the quaternion has no direction; expected qx qy qz qw of length 1");
}

namespace {

Result<void> report_unknown(Reading& reading) {
  for (const GraphSource& source : reading.sources) {
    for (const auto& unknown : source.unknown_tags()) {
      const std::string kept =
          unknown.lines == 1 ? "; the line is kept as it is"
                             : "; " + std::to_string(unknown.lines) + " lines are kept as they are";
      Result<void> warned =
          reading.warn(source.place(unknown.first_line),
                       "unknown tag " + quote(unknown.tag) + (reading.options.strict ? "" : kept));
      if (!warned) return warned;
    }
    auto& lines = reading.document.unknown_lines;
    lines.insert(lines.end(), source.unknown_lines().begin(), source.unknown_lines().end());
  }
  return {};
}

// Calls visit(source, record, tag, fields) for each line of a role, parsed.
template <class Visit>
Result<void> for_each_parsed(const Reading& reading, TagRole role, Visit visit) {
  LineFields fields;
  for (const GraphSource& source : reading.sources) {
    Result<void> done = source.for_each(role, [&](const Record& record, const TagSpec& tag) {
      Result<void> read = source.read(record, tag, fields);
      return read ? visit(source, record, tag, fields) : read;
    });
    if (!done) return done;
  }
  return {};
}

Result<void> read_equivalences(Reading& reading) {
  return for_each_parsed(reading, TagRole::kEquivalence,
                         [&](const GraphSource&, const Record&, const TagSpec&,
                             const LineFields& fields) -> Result<void> {
                           const VariableId a{fields.ids[0]}, b{fields.ids[1]};
                           reading.equivalence.merge(a, b);
                           reading.document.equivalences.emplace_back(a, b);
                           return {};
                         });
}

// An EQUIV between ids that nothing else mentions is a slip.
Result<void> check_equivalences(const Reading& reading) {
  return for_each_parsed(reading, TagRole::kEquivalence,
                         [&](const GraphSource& source, const Record& record, const TagSpec&,
                             const LineFields& fields) -> Result<void> {
                           const VariableId a{fields.ids[0]};
                           if (reading.document.graph.find(reading.equivalence.root(a))) return {};
                           return source.error_at(
                               record, 0, "vertex " + std::to_string(a.value) + " is not defined");
                         });
}

bool same_offset(const GraphDocument& document, ParameterId id, const Se2& offset) {
  return document.offsets2.at(id).to_vector() == offset.to_vector();
}
bool same_offset(const GraphDocument& document, ParameterId id, const Se3& offset) {
  const Se3& known = document.offsets3.at(id);
  return known.translation() == offset.translation() &&
         known.rotation().quaternion().coeffs() == offset.rotation().quaternion().coeffs();
}

Result<void> read_parameters(Reading& reading) {
  GraphDocument& document = reading.document;
  return for_each_parsed(
      reading, TagRole::kParameter,
      [&](const GraphSource& source, const Record& record, const TagSpec& tag,
          const LineFields& fields) -> Result<void> {
        if (Result<void> unit = check_quaternion(source, record, tag, fields); !unit) return unit;
        const ParameterId id{static_cast<std::int64_t>(fields.ids[0])};
        if (id.value < 0) return source.error_at(record, 0, "the parameter id is beyond 2^63 - 1");
        const auto fresh_or_same = [&](auto& offsets, const auto& offset) {
          return offsets.emplace(id, offset).second ||
                 (reading.sources.size() > 1 && same_offset(document, id, offset));
        };
        const bool accepted =
            tag.quaternion < 0
                ? fresh_or_same(document.offsets2, se2_from_columns(fields.numbers))
                : fresh_or_same(document.offsets3, se3_from_quaternion_columns(fields.numbers));
        if (accepted) return {};
        return source.error_at(record, 0,
                               "parameter " + std::to_string(fields.ids[0]) + " is defined twice");
      });
}

Result<void> fix(Reading& reading, const GraphSource& source, const Record& record) {
  const auto wrong = [&](const Field& field, std::string message) {
    return Error{ErrorCode::kBadInput, std::move(message),
                 place_in(source.name(), record.line_number, field.column)};
  };
  Graph& graph = reading.document.graph;
  FieldCursor fields(record);
  std::optional<Field> field = fields.next();
  if (!field) return source.error_at(record, 0, "FIX expects 1 or more vertex ids, found 0");
  for (; field; field = fields.next()) {
    VariableId id;
    if (parse_id(field->text, id.value) != NumberFault::kNone) {
      return wrong(*field, describe_id_fault(field->text));
    }
    const auto slot = graph.find(reading.equivalence.root(id));
    if (!slot) return wrong(*field, "vertex " + std::to_string(id.value) + " is not defined");
    graph.set_fixed(*slot, true);
  }
  return {};
}

Result<void> read_fixed(Reading& reading) {
  for (const GraphSource& source : reading.sources) {
    Result<void> read = source.for_each(TagRole::kFix, [&](const Record& record, const TagSpec&) {
      return fix(reading, source, record);
    });
    if (!read) return read;
  }
  return {};
}

void finish(GraphDocument& document, std::size_t vertices) {
  const std::size_t count = document.graph.variables().size();
  document.has_start.assign(count, false);
  std::fill_n(document.has_start.begin(), vertices, true);
  if (vertices < count) chain_start_values(document.graph, document.has_start);
  classify_factor_kinds(document.graph);
}

}  // namespace

Result<GraphDocument> read_graph_texts(const std::vector<NamedText>& texts,
                                       const ReadOptions& options) {
  Reading reading;
  reading.options = options;
  for (const NamedText& text : texts) {
    Result<GraphSource> source = GraphSource::survey(text, options.format);
    if (!source) return source.error();
    reading.sources.push_back(std::move(*source));
  }
  reading.document.format = reading.sources.front().format();
  using Step = Result<void> (*)(Reading&);
  for (const Step step : {report_unknown, read_equivalences, read_parameters, read_vertices}) {
    if (Result<void> done = step(reading); !done) return done.error();
  }
  const std::size_t vertices = reading.document.graph.variables().size();
  for (const Step step : {read_edges, read_fixed}) {
    if (Result<void> done = step(reading); !done) return done.error();
  }
  if (Result<void> done = check_equivalences(reading); !done) return done.error();
  finish(reading.document, vertices);
  return std::move(reading.document);
}

}  // namespace cairn
