// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/vertex_lines.hpp"

#include <algorithm>

#include "cairn/diagnostics/line_repairs.hpp"
#include "cairn/diagnostics/sound_text.hpp"
#include "cairn/io/roll_pitch_yaw.hpp"
#include "cairn/io/start_values.hpp"

namespace cairn {
namespace {

std::vector<double> value_columns(const Graph& graph, const Variable& variable,
                                  bool as_quaternion) {
  const Values& values = graph.values();
  switch (variable.type) {
    case VariableType::kPose2: {
      const Se2& T = values.pose2[variable.index];
      return {T.x(), T.y(), T.theta()};
    }
    case VariableType::kPose3: {
      const Se3& T = values.pose3[variable.index];
      const Eigen::Vector3d& t = T.translation();
      const Eigen::Quaterniond& q = T.rotation().quaternion();
      if (as_quaternion) return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
      const std::array<double, 3> angles = roll_pitch_yaw_from_rotation(T.rotation());
      return {t.x(), t.y(), t.z(), angles[0], angles[1], angles[2]};
    }
    case VariableType::kPoint2: {
      const Eigen::Vector2d& p = values.point2[variable.index];
      return {p.x(), p.y()};
    }
    case VariableType::kPoint3: {
      const Eigen::Vector3d& p = values.point3[variable.index];
      return {p.x(), p.y(), p.z()};
    }
  }
  return {};
}

// "VERTEX_SE2 7 1 2 0.5", or nothing where the graph does not know the vertex.
std::string vertex_line(const Graph& graph, GraphFormat format, std::uint64_t id) {
  const auto slot = graph.find(VariableId{id});
  if (!slot) return {};
  const Variable& variable = graph.variables()[*slot];
  const TagSpec* tag = vertex_tag(format, variable.type);
  if (!tag) return {};
  std::string line = std::string(tag->name) + " " + std::to_string(id);
  for (const double column : value_columns(graph, variable, tag->quaternion >= 0))
    line += " " + shortest(column);
  return line;
}

// Its numbers cannot be read, but its id can.
bool needs_start(const RawLine& line) {
  return line.broken && !line.unusable && line.tag->role == TagRole::kVertex;
}

}  // namespace

void repair_missing_vertices(const RawGraph& raw, const RawStructure& structure, const Graph& read,
                             Repairs& repairs) {
  if (raw.format == GraphFormat::kIsam) return;
  Graph graph = read;
  std::vector<bool> has_start(graph.variables().size(), true);
  const auto forget = [&](std::uint64_t id) {
    if (const auto slot = graph.find(VariableId{id})) has_start[*slot] = false;
  };
  for (const RawLine& line : raw.lines) {
    if (needs_start(line)) forget(line.ids[0]);
  }
  for (const std::uint64_t id : structure.dangling) forget(id);
  if (std::find(has_start.begin(), has_start.end(), false) == has_start.end()) return;
  chain_start_values(graph, has_start);
  for (const RawLine& line : raw.lines) {
    if (!needs_start(line) || !repairs.open(line.line)) continue;
    std::string text = vertex_line(graph, raw.format, line.ids[0]);
    if (text.empty()) continue;
    repairs.replace(line.fault, line.line, {{line.text, std::move(text)}},
                    "wrote the start that the edges give for " + describe(line));
  }
  for (const std::uint64_t id : structure.dangling) {
    if (structure.vertices.at(id).edges < 2) continue;
    std::string text = vertex_line(graph, raw.format, id);
    if (!text.empty()) repairs.append(CheckCode::kDanglingId, text, "added " + text);
  }
}

void repair_gauge(const RawGraph& raw, const std::vector<Component>& components, Repairs& repairs) {
  if (raw.format != GraphFormat::kG2o) return;
  for (const Component& component : components) {
    if (!component.needs_gauge() || !component.smallest_pose) continue;
    const std::string id = std::to_string(component.smallest_pose->value);
    repairs.append(CheckCode::kNothingFixed, "FIX " + id, "added FIX " + id);
  }
}

}  // namespace cairn
