// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/relative_pose_graph.hpp"

#include <algorithm>
#include <deque>
#include <type_traits>

namespace cairn {
namespace {

template <class Pose>
constexpr VariableType kPoseType =
    std::is_same_v<Pose, Se2> ? VariableType::kPose2 : VariableType::kPose3;

template <class Pose>
std::vector<RelativePose<Pose>> relative_poses(const FactorBatch& batch) {
  if constexpr (std::is_same_v<Pose, Se2>) {
    return batch.relative_poses2();
  } else {
    return batch.relative_poses3();
  }
}

}  // namespace

template <class Pose>
RelativePoseGraph<Pose>::RelativePoseGraph(const Problem& problem) {
  const std::span<const Variable> variables = problem.graph->variables();
  std::vector<std::pair<std::uint64_t, std::uint32_t>> by_id;
  for (std::size_t slot = 0; slot < variables.size(); ++slot) {
    if (variables[slot].type != kPoseType<Pose>) continue;
    by_id.emplace_back(variables[slot].id.value, variables[slot].index);
    held.push_back(problem.held[slot]);  // indices of a type ascend with the slots
  }
  if (!std::is_sorted(by_id.begin(), by_id.end())) std::sort(by_id.begin(), by_id.end());
  for (const auto& [id, index] : by_id) poses_by_id.push_back(index);
  for (const FactorBatch* batch : problem.batches) {
    const std::vector<RelativePose<Pose>> measured = relative_poses<Pose>(*batch);
    for (std::size_t i = 0; i < measured.size(); ++i)
      edges.push_back({measured[i], batch->kinds()[i]});
  }
  incidence_begin.assign(held.size() + 2, 0);
  for (const Edge& edge : edges) {
    ++incidence_begin[edge.measured.a + 2];
    ++incidence_begin[edge.measured.b + 2];
  }
  for (std::size_t i = 2; i < incidence_begin.size(); ++i)
    incidence_begin[i] += incidence_begin[i - 1];
  incidences.resize(2 * edges.size());
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const RelativePose<Pose>& measured = edges[e].measured;
    incidences[incidence_begin[measured.a + 1]++] = {e, measured.b, true};
    incidences[incidence_begin[measured.b + 1]++] = {e, measured.a, false};
  }
  incidence_begin.pop_back();
}

template <class Pose>
void chain_poses(const RelativePoseGraph<Pose>& graph, bool odometry_first,
                 std::vector<Pose>& poses) {
  std::vector<bool> reached = graph.held;
  std::deque<std::uint32_t> frontier,
      waiting;  // waiting: their loop closures were not followed yet
  for (const std::uint32_t pose : graph.poses_by_id) {
    if (graph.held[pose]) frontier.push_back(pose);
  }
  const auto follow = [&](std::uint32_t pose, bool odometry_only) {
    for (std::uint32_t k = graph.incidence_begin[pose]; k < graph.incidence_begin[pose + 1]; ++k) {
      const auto& [e, other, forward] = graph.incidences[k];
      const auto& edge = graph.edges[e];
      if (reached[other] || (odometry_only && edge.kind != FactorKind::kOdometry)) continue;
      reached[other] = true;
      poses[other] = poses[pose] * (forward ? edge.measured.T_a_b : edge.measured.T_a_b.inverse());
      frontier.push_back(other);
      if (odometry_first && !odometry_only)
        return true;  // see where odometry leads from here first
    }
    return false;
  };
  const auto spread = [&] {
    while (!frontier.empty() || !waiting.empty()) {
      if (!frontier.empty()) {
        const std::uint32_t pose = frontier.front();
        frontier.pop_front();
        follow(pose, odometry_first);
        if (odometry_first) waiting.push_back(pose);
      } else if (!follow(waiting.front(), false)) {
        waiting.pop_front();
      }
    }
  };
  spread();
  for (const std::uint32_t pose : graph.poses_by_id) {
    if (reached[pose]) continue;
    reached[pose] = true;
    frontier.push_back(pose);
    spread();
  }
}

template struct RelativePoseGraph<Se2>;
template struct RelativePoseGraph<Se3>;
template void chain_poses(const RelativePoseGraph<Se2>&, bool, std::vector<Se2>&);
template void chain_poses(const RelativePoseGraph<Se3>&, bool, std::vector<Se3>&);

}  // namespace cairn
