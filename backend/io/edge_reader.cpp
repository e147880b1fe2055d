// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "cairn/io/copy_filter.hpp"
#include "cairn/io/reading.hpp"

namespace cairn {
namespace {

std::string vertex_tag(const GraphSource& source, VariableType type) {
  for (const TagSpec& tag : source.tags()) {
    if (tag.role == TagRole::kVertex && tag.variables[0] == type) return std::string(tag.name);
  }
  return "VERTEX";
}

class EdgeReader {
 public:
  explicit EdgeReader(Reading& reading) : reading_(reading), graph_(reading.document.graph) {}

  Result<void> read() {
    for (source_index_ = 0; source_index_ < reading_.sources.size(); ++source_index_) {
      const GraphSource& source = reading_.sources[source_index_];
      for (const TagSpec& tag : source.tags()) {
        const bool counted = tag.role == TagRole::kEdge && !source.has_twin(tag);
        if (counted && source.count(tag) > 0)
          source.decoder(tag).reserve(graph_, source.count(tag));
      }
      Result<void> read = source.for_each(
          TagRole::kEdge,
          [&](const Record& record, const TagSpec& tag) { return add(source, record, tag); });
      if (!read) return read;
    }
    return warn_of_dropped();
  }

 private:
  Result<void> add(const GraphSource& source, const Record& record, const TagSpec& named) {
    const TagSpec* tag = &named;
    if (source.has_twin(named)) {
      if (Result<void> known = choose_twin(source, record, tag); !known) return known;
    }
    if (Result<void> read = source.read(record, *tag, fields_); !read) return read;
    if (Result<void> unit = check_quaternion(source, record, *tag, fields_); !unit) return unit;
    EdgeFields edge = edge_fields(*tag);
    if (Result<void> found = find_offsets(source, record, edge); !found) return found;
    const std::span<const VariableId> ids(edge.ids.data(),
                                          static_cast<std::size_t>(tag->variable_count));
    if (reading_.sources.size() > 1 && copies_.is_copy(source_index_, *tag, ids, edge.measurement))
      return {};
    const FactorKind kind = tag->name == "ODOMETRY" ? FactorKind::kOdometry : FactorKind::kOther;
    const Result<FactorRef> added = source.decoder(*tag).add(graph_, edge, kind);
    return added ? Result<void>() : add_refused(source, record, edge, kind, added.error());
  }

  Result<void> choose_twin(const GraphSource& source, const Record& record, const TagSpec*& tag) {
    const auto type_of_first = [&]() -> std::optional<VariableType> {
      const auto id = find_id(record, 0);
      const auto slot = id ? graph_.find(reading_.equivalence.root(*id)) : std::nullopt;
      if (!slot) return std::nullopt;
      return graph_.variables()[*slot].type;
    };
    if (!type_of_first()) {
      if (Result<void> inferred = infer(); !inferred) return inferred;
    }
    const TagSpec* fitting = fitting_tag(source, record, *tag, type_of_first());
    if (fitting) tag = fitting;
    return {};
  }

  EdgeFields edge_fields(const TagSpec& tag) const {
    EdgeFields edge;
    edge.tag = &tag;
    const auto variables = static_cast<std::size_t>(tag.variable_count);
    for (std::size_t k = 0; k < variables; ++k) {
      edge.ids[k] = reading_.equivalence.root(VariableId{fields_.ids[k]});
    }
    for (std::size_t k = 0; k < static_cast<std::size_t>(tag.parameter_count); ++k) {
      edge.parameters[k] = ParameterId{static_cast<std::int64_t>(fields_.ids[variables + k])};
    }
    const std::span<const double> numbers(fields_.numbers.data(),
                                          static_cast<std::size_t>(fields_.number_count));
    edge.measurement = numbers.first(static_cast<std::size_t>(tag.measurement));
    edge.information = numbers.subspan(static_cast<std::size_t>(tag.measurement));
    return edge;
  }

  Result<void> find_offsets(const GraphSource& source, const Record& record,
                            EdgeFields& edge) const {
    const GraphDocument& document = reading_.document;
    const bool planar = edge.tag->variables[0] == VariableType::kPose2;
    for (std::size_t k = 0; k < static_cast<std::size_t>(edge.tag->parameter_count); ++k) {
      if (planar) {
        const auto found = document.offsets2.find(edge.parameters[k]);
        if (found != document.offsets2.end()) edge.offsets2[k] = &found->second;
      } else {
        const auto found = document.offsets3.find(edge.parameters[k]);
        if (found != document.offsets3.end()) edge.offsets3[k] = &found->second;
      }
      if (edge.offsets2[k] || edge.offsets3[k]) continue;
      const std::string parameter = planar ? "PARAMS_SE2OFFSET" : "PARAMS_SE3OFFSET";
      const int field = edge.tag->variable_count + static_cast<int>(k);
      return source.error_at(record, field,
                             "parameter " +
                                 std::to_string(fields_.ids[static_cast<std::size_t>(field)]) +
                                 " is not defined; add its " + parameter + " line");
    }
    return {};
  }

  // The slow path: variables that only edges mention, or an error with its exact place.
  Result<void> add_refused(const GraphSource& source, const Record& record, const EdgeFields& edge,
                           FactorKind kind, const Error& refusal) {
    if (!has_all_variables(edge) && !inferred_) {
      if (Result<void> inferred = infer(); !inferred) return inferred;
      const Result<FactorRef> added = source.decoder(*edge.tag).add(graph_, edge, kind);
      return added ? Result<void>() : add_refused(source, record, edge, kind, added.error());
    }
    for (int k = 0; k < edge.tag->variable_count; ++k) {
      if (Result<void> fits = check_variable(source, record, edge, k); !fits) return fits;
    }
    if (edge.tag->variable_count == 2 && edge.ids[0] == edge.ids[1])
      return self_edge(source, record, edge);
    const int first_of_information = edge.tag->id_columns() + edge.tag->measurement;
    if (refusal.message.find("information") == std::string::npos) {
      return source.error_at(record, edge.tag->id_columns(), refusal.message);
    }
    return source.error_at(
        record, first_of_information,
        std::string(edge.tag->name) + " information is not positive semidefinite; " +
            "'cairn check' tells its smallest eigenvalue and repairs it with --fix");
  }

  [[nodiscard]] bool has_all_variables(const EdgeFields& edge) const {
    return std::all_of(edge.ids.begin(), edge.ids.begin() + edge.tag->variable_count,
                       [&](VariableId id) { return graph_.find(id).has_value(); });
  }

  Result<void> infer() {
    if (inferred_) return {};
    inferred_ = true;
    return add_missing_variables(reading_);
  }

  Result<void> check_variable(const GraphSource& source, const Record& record,
                              const EdgeFields& edge, int k) const {
    const auto at = static_cast<std::size_t>(k);
    const VariableType expected = edge.tag->variables[at];
    const std::string vertex = "vertex " + std::to_string(fields_.ids[at]);
    const auto slot = graph_.find(edge.ids[at]);
    if (!slot) {
      const std::string line = vertex_tag(source, expected);
      return source.error_at(record, k,
                             vertex + " is not defined; add its " + line +
                                 " line, or leave out all " + line +
                                 " lines to start from the edges");
    }
    const VariableType found = graph_.variables()[*slot].type;
    if (found == expected) return {};
    return source.error_at(record, k,
                           vertex + " is a " + std::string(to_string(found)) + ", but " +
                               std::string(edge.tag->name) + " needs a " +
                               std::string(to_string(expected)));
  }

  Result<void> self_edge(const GraphSource& source, const Record& record, const EdgeFields& edge) {
    if (fields_.ids[0] == fields_.ids[1]) {
      return source.error_at(record, 1,
                             std::string(edge.tag->name) + " connects vertex " +
                                 std::to_string(fields_.ids[0]) + " with itself");
    }
    if (dropped_++ == 0) first_dropped_ = source.place(record.line_number);
    return {};
  }

  // Edges inside one variable say nothing about where it is.
  Result<void> warn_of_dropped() {
    if (dropped_ == 0) return {};
    return reading_.warn(
        first_dropped_,
        dropped_ == 1
            ? "an edge joins two ids of one pose (EQUIV) and is dropped"
            : std::to_string(dropped_) + " edges join two ids of one pose (EQUIV) and are dropped");
  }

  Reading& reading_;
  Graph& graph_;
  std::size_t source_index_ = 0;
  LineFields fields_;
  CopyFilter copies_;
  bool inferred_ = false;
  std::size_t dropped_ = 0;
  std::string first_dropped_;
};

}  // namespace

const TagSpec* fitting_tag(const GraphSource& source, const Record& record, const TagSpec& tag,
                           const std::optional<VariableType>& first) {
  if (!source.has_twin(tag)) return &tag;
  if (first) return &variant_for(source.format(), tag, *first);
  const TagSpec& planar = variant_for(source.format(), tag, VariableType::kPose2);
  const TagSpec& spatial = variant_for(source.format(), tag, VariableType::kPose3);
  if (planar.columns() == spatial.columns()) return nullptr;
  return count_fields(record) == static_cast<std::size_t>(spatial.columns()) ? &spatial : &planar;
}

std::optional<VariableId> find_id(const Record& record, int field) {
  const auto found = field_at(record, static_cast<std::size_t>(field));
  VariableId id;
  if (!found || parse_id(found->text, id.value) != NumberFault::kNone) return std::nullopt;
  return id;
}

Result<void> read_edges(Reading& reading) { return EdgeReader(reading).read(); }

}  // namespace cairn
