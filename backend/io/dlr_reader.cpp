// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "cairn/io/graph_reader.hpp"
#include "cairn/io/reading.hpp"

namespace cairn {
namespace {

// Lines here begin with a number: the record's fields start at its tag.
bool next_line(RecordScanner& scanner, Record& record) {
  if (!scanner.next(record)) return false;
  record.tag = record.tag.substr(0, 0);
  return true;
}

Error error_in(const NamedText& text, const Record& record, std::size_t field,
               std::string message) {
  const auto found = field_at(record, field);
  return {ErrorCode::kBadInput, std::move(message),
          place_in(text.name, record.line_number, found ? found->column : 1)};
}

Result<std::vector<double>> read_state(const NamedText& text) {
  std::vector<double> state;
  RecordScanner scanner(text.text, ',');
  Record record;
  while (next_line(scanner, record)) {
    double number;
    if (Result<void> read = read_fields(record, text.name, {}, {&number, 1}); !read)
      return read.error();
    state.push_back(number);
  }
  return state;
}

// `id, offset into the state, dimension`: 3 a pose, 2 a landmark.
Result<void> read_vertices(const NamedText& text, const std::vector<double>& state, Graph& graph) {
  RecordScanner scanner(text.text, ',');
  Record record;
  while (next_line(scanner, record)) {
    std::array<std::uint64_t, 3> fields;
    if (Result<void> read = read_fields(record, text.name, fields, {}); !read) return read;
    const auto [id, offset, dimension] = fields;
    if (dimension != 3 && dimension != 2) {
      return error_in(
          text, record, 2,
          "dimension " + std::to_string(dimension) + "; expected 3 (a pose) or 2 (a landmark)");
    }
    if (offset > state.size() || dimension > state.size() - offset) {
      return error_in(text, record, 1,
                      "offset " + std::to_string(offset) + " points behind the state of " +
                          std::to_string(state.size()) + " numbers");
    }
    const double* x = state.data() + offset;
    const auto added = dimension == 3 ? graph.add_pose2({id}, {x[0], x[1], x[2]})
                                      : graph.add_point2({id}, {x[0], x[1]});
    if (!added)
      return error_in(text, record, 0, "vertex " + std::to_string(id) + " is defined twice");
  }
  return {};
}

// Files round to six digits, and off-diagonal entries may be small against the diagonal.
bool is_symmetric(std::span<const double> m, int n) {
  double largest = 0.0;
  for (const double x : m) largest = std::max(largest, std::abs(x));
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < i; ++j) {
      const double difference =
          m[static_cast<std::size_t>(i * n + j)] - m[static_cast<std::size_t>(j * n + i)];
      if (std::abs(difference) > 1e-5 * largest) return false;
    }
  }
  return true;
}

Result<void> read_edge(const NamedText& text, const Record& record, const TagSpec& tag,
                       Graph& graph) {
  LineFields fields;
  fields.number_count = tag.measurement + tag.information_columns();
  const std::span<double> numbers(fields.numbers.data(),
                                  static_cast<std::size_t>(fields.number_count));
  Result<void> read = read_fields(record, text.name, std::span(fields.ids).first(2), numbers);
  if (!read) return read;
  EdgeFields edge;
  edge.tag = &tag;
  edge.ids = {VariableId{fields.ids[0]}, VariableId{fields.ids[1]}};
  edge.measurement = numbers.first(static_cast<std::size_t>(tag.measurement));
  edge.information = numbers.subspan(static_cast<std::size_t>(tag.measurement));
  const auto information_at = static_cast<std::size_t>(2 + tag.measurement);
  if (!is_symmetric(edge.information, tag.information)) {
    return error_in(text, record, information_at, "the information matrix is not symmetric");
  }
  const auto added = edge_decoder(tag).add(graph, edge, FactorKind::kOther);
  return added ? Result<void>() : error_in(text, record, 0, added.error().message);
}

Result<void> read_edges(const NamedText& text, Graph& graph) {
  RecordScanner scanner(text.text, ',');
  Record record;
  while (scanner.next(record)) {
    const TagSpec* tag = find_tag(GraphFormat::kDlr, record.tag);
    if (!tag) {
      return Error{ErrorCode::kBadInput,
                   "'" + quote(record.tag) + "' is not a kind of edge; expected P or L",
                   place_in(text.name, record.line_number, 1)};
    }
    if (Result<void> read = read_edge(text, record, *tag, graph); !read) return read;
  }
  return {};
}

}  // namespace

Result<GraphDocument> read_dlr_texts(const DlrTexts& texts) {
  GraphDocument document;
  document.format = GraphFormat::kDlr;
  const auto state = read_state(texts.state);
  if (!state) return state.error();
  Result<void> done = read_vertices(texts.vertices, *state, document.graph);
  if (done) done = read_edges(texts.edges, document.graph);
  if (!done) return done.error();
  document.has_start.assign(document.graph.variables().size(), true);
  classify_factor_kinds(document.graph);
  return document;
}

}  // namespace cairn
