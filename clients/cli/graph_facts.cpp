// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/graph_facts.hpp"

#include <algorithm>

#include "cairn/diagnostics/components.hpp"
#include "cairn/solver/optimize.hpp"

namespace cairn::cli {
namespace {

Eigen::Vector3d position(const Values& values, const Variable& variable) {
  const auto planar = [](const Eigen::Vector2d& p) { return Eigen::Vector3d(p.x(), p.y(), 0.0); };
  switch (variable.type) {
    case VariableType::kPose2:
      return planar(values.pose2[variable.index].translation());
    case VariableType::kPose3:
      return values.pose3[variable.index].translation();
    case VariableType::kPoint2:
      return planar(values.point2[variable.index]);
    case VariableType::kPoint3:
      break;
  }
  return values.point3[variable.index];
}

double path_length(const Graph& graph) {
  std::vector<Variable> poses;
  for (const Variable& variable : graph.variables()) {
    if (is_pose(variable.type)) poses.push_back(variable);
  }
  std::sort(poses.begin(), poses.end(),
            [](const Variable& a, const Variable& b) { return a.id < b.id; });
  double length = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const bool same_robot = poses[i - 1].id.value >> 56 == poses[i].id.value >> 56;
    if (!same_robot || poses[i - 1].type != poses[i].type) continue;
    length += (position(graph.values(), poses[i]) - position(graph.values(), poses[i - 1])).norm();
  }
  return length;
}

void count_variables(const GraphDocument& document, GraphFacts& facts) {
  const Graph& graph = document.graph;
  for (const Variable& variable : graph.variables()) {
    ++facts.variables[std::string(to_string(variable.type))];
    const Eigen::Vector3d p = position(graph.values(), variable);
    facts.lowest = facts.lowest.cwiseMin(p);
    facts.highest = facts.highest.cwiseMax(p);
    if (variable.fixed) ++facts.fixed;
    if (!variable.fixed) facts.degrees_of_freedom -= tangent_dimension(variable.type);
  }
  const auto started = std::count(document.has_start.begin(), document.has_start.end(), true);
  facts.without_start = graph.variables().size() - static_cast<std::size_t>(started);
}

void count_factors(const Graph& graph, GraphFacts& facts) {
  for (const auto& batch : graph.batches()) {
    if (batch->size() == 0) continue;
    facts.factors[std::string(batch->type_name())] += batch->size();
    facts.degrees_of_freedom += static_cast<long>(batch->size()) * batch->residual_dimension();
    for (const FactorKind kind : batch->kinds()) {
      facts.odometry += kind == FactorKind::kOdometry;
      facts.loops += kind == FactorKind::kLoop;
    }
  }
}

void count_components(const Graph& graph, GraphFacts& facts) {
  for (const Component& component : connected_components(graph)) {
    ++facts.components;
    if (!component.needs_gauge()) continue;
    ++facts.components_without_gauge;
    if (!component.smallest_pose) continue;
    const VariableSlot held = *graph.find(*component.smallest_pose);
    facts.degrees_of_freedom += tangent_dimension(graph.variables()[held].type);
  }
}

}  // namespace

GraphFacts collect_facts(const GraphDocument& document) {
  GraphFacts facts;
  count_variables(document, facts);
  count_factors(document.graph, facts);
  count_components(document.graph, facts);
  facts.path_m = path_length(document.graph);
  const bool has_vertices = facts.without_start < document.graph.variables().size();
  if (has_vertices) facts.chi2 = compute_chi2(document.graph);
  return facts;
}

}  // namespace cairn::cli
