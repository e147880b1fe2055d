// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/trajectory.hpp"

#include <algorithm>

#include "cairn/io/graph_file.hpp"
#include "cairn/io/input_text.hpp"

namespace cairn {
namespace {

Se3 in_space(const Se2& T) { return {So3::exp({0.0, 0.0, T.theta()}), {T.x(), T.y(), 0.0}}; }

Result<Trajectory> poses_of(const Result<GraphDocument>& document, const std::string& name) {
  if (!document) return document.error();
  Trajectory trajectory = trajectory_of(document->graph, name);
  if (trajectory.poses.empty()) return Error{ErrorCode::kBadInput, "the graph has no poses", name};
  trajectory.warnings = document->warnings;
  if (std::find(document->has_start.begin(), document->has_start.end(), false) !=
      document->has_start.end()) {
    trajectory.warnings.push_back(
        name + ": has edges without vertices; the poses compared are chains of edges");
  }
  return trajectory;
}

}  // namespace

Trajectory trajectory_of(const Graph& graph, const std::string& name) {
  Trajectory trajectory{.name = name, .format = TrajectoryFormat::kGraph, .planar = true};
  for (const Variable& variable : graph.variables()) {
    if (variable.type == VariableType::kPose2) {
      trajectory.poses.push_back(
          {variable.id.value, in_space(graph.values().pose2[variable.index])});
    } else if (variable.type == VariableType::kPose3) {
      trajectory.poses.push_back({variable.id.value, graph.values().pose3[variable.index]});
      trajectory.planar = false;
    }
  }
  std::sort(trajectory.poses.begin(), trajectory.poses.end(),
            [](const TrajectoryPose& a, const TrajectoryPose& b) { return a.key < b.key; });
  return trajectory;
}

Result<Trajectory> read_trajectory(const std::string& path) {
  std::error_code absent;
  if (std::filesystem::is_directory(path, absent)) return poses_of(read_graph(path), path);
  const Result<InputText> text = read_input_text(path);
  if (!text) return text.error();
  const std::string name = input_name(path);
  if (recognize_trajectory(text->view)) return read_trajectory_text(text->view, name);
  return poses_of(read_graph_text(text->view, name), name);
}

}  // namespace cairn
