// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "cairn/io/reading.hpp"

namespace cairn {
namespace {

using VertexColumns = std::array<double, 7>;

VertexColumns columns_of(const LineFields& fields) {
  VertexColumns columns;
  std::copy_n(fields.numbers.begin(), columns.size(), columns.begin());
  return columns;
}

Result<VariableSlot> add_variable(Graph& graph, VariableId id, const TagSpec& tag,
                                  const VertexColumns& value) {
  switch (tag.variables[0]) {
    case VariableType::kPose2:
      return graph.add_pose2(id, se2_from_columns(value));
    case VariableType::kPose3:
      return graph.add_pose3(id, tag.quaternion < 0 ? se3_from_roll_pitch_yaw_columns(value)
                                                    : se3_from_quaternion_columns(value));
    case VariableType::kPoint2:
      return graph.add_point2(id, {value[0], value[1]});
    case VariableType::kPoint3:
      break;
  }
  return graph.add_point3(id, {value[0], value[1], value[2]});
}

// Whether two values are one as far as files tell, which are often written with six digits.
bool are_close(const Graph& a, const Variable& in_a, const Graph& b) {
  constexpr double kTolerance = 1e-5;  // m, rad
  const auto small = [](const auto& difference) {
    return difference.cwiseAbs().maxCoeff() <= kTolerance;
  };
  const std::uint32_t i = in_a.index;
  switch (in_a.type) {
    case VariableType::kPose2:
      return small((a.values().pose2[i].inverse() * b.values().pose2[0]).log());
    case VariableType::kPose3:
      return small((a.values().pose3[i].inverse() * b.values().pose3[0]).log());
    case VariableType::kPoint2:
      return small(a.values().point2[i] - b.values().point2[0]);
    case VariableType::kPoint3:
      break;
  }
  return small(a.values().point3[i] - b.values().point3[0]);
}

class VertexReader {
 public:
  explicit VertexReader(Reading& reading) : reading_(reading), graph_(reading.document.graph) {}

  Result<void> read() {
    for (const GraphSource& source : reading_.sources) {
      make_room(source);
      first_slot_ = static_cast<VariableSlot>(graph_.variables().size());
      Result<void> read = source.for_each(
          TagRole::kVertex,
          [&](const Record& record, const TagSpec& tag) { return add(source, record, tag); });
      if (!read) return read;
    }
    return add_aliases();
  }

 private:
  struct Alias {
    VariableId root;
    const TagSpec* tag;
    VertexColumns value;
  };

  void make_room(const GraphSource& source) {
    std::size_t total = graph_.variables().size();
    for (const TagSpec& tag : source.tags()) {
      if (tag.role != TagRole::kVertex) continue;
      std::size_t& of_type = counts_[static_cast<std::size_t>(tag.variables[0])];
      of_type += source.count(tag);
      total += source.count(tag);
      graph_.reserve_values(tag.variables[0], of_type);
    }
    graph_.reserve(total);
  }

  Result<void> add(const GraphSource& source, const Record& record, const TagSpec& tag) {
    if (Result<void> read = source.read(record, tag, fields_); !read) return read;
    if (Result<void> unit = check_quaternion(source, record, tag, fields_); !unit) return unit;
    const VariableId id{fields_.ids[0]}, root = reading_.equivalence.root(id);
    reading_.has_vertices[static_cast<std::size_t>(tag.variables[0])][id.value >> 56] = true;
    if (root != id) {
      aliases_.push_back({root, &tag, columns_of(fields_)});
      return {};
    }
    if (add_variable(graph_, id, tag, columns_of(fields_))) return {};
    const Variable& known = graph_.variables()[*graph_.find(id)];
    return *graph_.find(id) >= first_slot_ ? twice_in_one_file(source, record, id)
                                           : again_in_another_file(source, record, tag, known);
  }

  Result<void> twice_in_one_file(const GraphSource& source, const Record& record, VariableId id) {
    std::size_t first_line = 0;
    const auto remember = [&](const Record& other, const TagSpec&) -> Result<void> {
      if (first_line == 0 && find_id(other, 0) == id) first_line = other.line_number;
      return {};
    };
    (void)source.for_each(TagRole::kVertex, remember);
    return source.error_at(record, 0,
                           "vertex " + std::to_string(id.value) +
                               " is defined twice, first in line " + std::to_string(first_line));
  }

  Result<void> again_in_another_file(const GraphSource& source, const Record& record,
                                     const TagSpec& tag, const Variable& known) {
    const std::string vertex = "vertex " + std::to_string(known.id.value);
    if (known.type != tag.variables[0]) {
      return source.error_at(
          record, 0, vertex + " is a " + std::string(to_string(known.type)) + " in another file");
    }
    Graph again;
    (void)add_variable(again, known.id, tag, columns_of(fields_));
    if (are_close(graph_, known, again)) return {};
    return reading_.warn(source.place(record.line_number),
                         vertex + " has another value in an earlier file, which is kept");
  }

  // Variables whose only lines are those of their other names.
  Result<void> add_aliases() {
    for (const Alias& alias : aliases_) {
      if (graph_.find(alias.root)) continue;
      const auto added = add_variable(graph_, alias.root, *alias.tag, alias.value);
      if (!added) return added.error();
    }
    return {};
  }

  Reading& reading_;
  Graph& graph_;
  LineFields fields_;
  std::array<std::size_t, 4> counts_{};
  VariableSlot first_slot_ = 0;  // of the source being read
  std::vector<Alias> aliases_;
};

}  // namespace

Result<void> read_vertices(Reading& reading) { return VertexReader(reading).read(); }

}  // namespace cairn
