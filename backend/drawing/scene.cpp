// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/drawing/scene.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace cairn::drawing {
namespace {

using Eigen::Vector3d;

constexpr int kRobotShift = 56;  // multi-robot files keep the robot in the top byte of the id
// Above this a squared distance is no longer a finite number.
constexpr double kLargest_m = 1e150;

Vector3d position(const Variable& variable, const Values& values) {
  switch (variable.type) {
    case VariableType::kPose2: {
      const Eigen::Vector2d& p = values.pose2[variable.index].translation();
      return {p.x(), p.y(), 0.0};
    }
    case VariableType::kPose3:
      return values.pose3[variable.index].translation();
    case VariableType::kPoint2: {
      const Eigen::Vector2d& p = values.point2[variable.index];
      return {p.x(), p.y(), 0.0};
    }
    case VariableType::kPoint3:
      return values.point3[variable.index];
  }
  return Vector3d::Zero();
}

Vector3d heading(const Variable& variable, const Values& values) {
  if (variable.type == VariableType::kPose3)
    return values.pose3[variable.index].rotation() * Vector3d::UnitX();
  const double theta = values.pose2[variable.index].theta();
  return {std::cos(theta), std::sin(theta), 0.0};
}

std::optional<Error> why_not_drawable(const Graph& graph, const Values& values) {
  if (graph.variables().empty()) {
    return Error{ErrorCode::kBadInput,
                 "the graph is empty: it has no poses and no landmarks to draw"};
  }
  std::size_t bad = 0;
  VariableId first{};
  for (const Variable& variable : graph.variables()) {
    if ((position(variable, values).array().abs() < kLargest_m).all()) continue;
    if (bad++ == 0) first = variable.id;
  }
  if (bad == 0) return std::nullopt;
  return Error{ErrorCode::kBadInput,
               std::to_string(bad) + " of " + std::to_string(graph.variables().size()) +
                   " variables have no finite position (the first is variable " +
                   std::to_string(first.value) + "); run `cairn check` on the graph"};
}

std::vector<VariableSlot> poses_by_id(const Graph& graph) {
  std::vector<VariableSlot> poses;
  for (VariableSlot s = 0; s < graph.variables().size(); ++s) {
    if (is_pose(graph.variables()[s].type)) poses.push_back(s);
  }
  std::sort(poses.begin(), poses.end(), [&](VariableSlot a, VariableSlot b) {
    return graph.variables()[a].id < graph.variables()[b].id;
  });
  return poses;
}

bool joins_two_poses(const FactorBatch& batch) {
  const auto signature = batch.signature();
  return signature.size() == 2 && is_pose(signature[0]) && is_pose(signature[1]);
}

// Calls body(batch, factor, slot a, slot b) for every factor between two poses.
template <class Body>
void for_each_relative(const Graph& graph, const Body& body) {
  for (const auto& batch : graph.batches()) {
    if (!joins_two_poses(*batch)) continue;
    const auto signature = batch->signature();
    const auto indices = batch->variable_indices();
    for (std::size_t i = 0; i < batch->size(); ++i) {
      body(*batch, i, graph.slot_of(signature[0], indices[2 * i]),
           graph.slot_of(signature[1], indices[2 * i + 1]));
    }
  }
}

// For each pose slot: does odometry lead to the next pose id?
std::vector<bool> joined_to_next(const Graph& graph, const std::vector<VariableSlot>& poses) {
  std::vector<std::size_t> rank(graph.variables().size());
  for (std::size_t r = 0; r < poses.size(); ++r) rank[poses[r]] = r;
  std::vector<bool> joined(graph.variables().size(), false);
  for_each_relative(graph,
                    [&](const FactorBatch& batch, std::size_t i, VariableSlot a, VariableSlot b) {
                      if (batch.kinds()[i] == FactorKind::kLoop) return;
                      if (rank[a] + 1 == rank[b]) joined[a] = true;
                      if (rank[b] + 1 == rank[a]) joined[b] = true;
                    });
  return joined;
}

void add_paths(const Graph& graph, const Values& values, Scene& scene) {
  const std::vector<VariableSlot> poses = poses_by_id(graph);
  const std::vector<bool> joined = joined_to_next(graph, poses);
  std::map<std::uint64_t, std::size_t> robots;
  bool goes_on = false;
  for (const VariableSlot slot : poses) {
    const Variable& variable = graph.variables()[slot];
    const std::size_t robot =
        robots.emplace(variable.id.value >> kRobotShift, robots.size()).first->second;
    if (!goes_on) scene.paths.push_back({.robot = robot, .heading = heading(variable, values)});
    scene.paths.back().positions.push_back(position(variable, values));
    goes_on = joined[slot];
  }
  scene.poses = poses.size();
  scene.robots = robots.size();
}

void add_loops(const Graph& graph, const Values& values, ErrorChart chart, Scene& scene) {
  const EvaluationContext context{.values = values, .chart = chart};
  for_each_relative(
      graph, [&](const FactorBatch& batch, std::size_t i, VariableSlot a, VariableSlot b) {
        if (batch.kinds()[i] != FactorKind::kLoop) return;
        double chi2 = 0.0;
        batch.evaluate_chi2(i, i + 1, context, &chi2);
        scene.loops.push_back({position(graph.variables()[a], values),
                               position(graph.variables()[b], values),
                               std::isfinite(chi2) ? std::sqrt(std::max(chi2, 0.0)) : kLargest_m});
      });
}

}  // namespace

std::vector<Vector3d> Scene::points() const {
  std::vector<Vector3d> all = landmarks;
  for (const Path& path : paths)
    all.insert(all.end(), path.positions.begin(), path.positions.end());
  return all;
}

Result<Scene> make_scene(const Graph& graph, const Values& values, ErrorChart chart) {
  if (auto error = why_not_drawable(graph, values)) return *error;
  Scene scene;
  add_paths(graph, values, scene);
  add_loops(graph, values, chart, scene);
  for (const Variable& variable : graph.variables()) {
    if (!is_pose(variable.type)) scene.landmarks.push_back(position(variable, values));
  }
  return scene;
}

}  // namespace cairn::drawing
