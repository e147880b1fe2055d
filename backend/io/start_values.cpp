// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/start_values.hpp"

#include <algorithm>
#include <numeric>

namespace cairn {
namespace {

template <class Pose>
struct PoseArray;
template <>
struct PoseArray<Se2> {
  static constexpr auto kType = VariableType::kPose2;
  static std::vector<Se2>& of(Values& values) { return values.pose2; }
  static std::vector<RelativePose<Se2>> relative(const FactorBatch& batch) {
    return batch.relative_poses2();
  }
};
template <>
struct PoseArray<Se3> {
  static constexpr auto kType = VariableType::kPose3;
  static std::vector<Se3>& of(Values& values) { return values.pose3; }
  static std::vector<RelativePose<Se3>> relative(const FactorBatch& batch) {
    return batch.relative_poses3();
  }
};

// The relative poses of a graph, and for each pose those that touch it: edges in the order of the
// batches, neighbors[begin[i]] to neighbors[begin[i + 1]].
template <class Pose>
struct Adjacency {
  std::vector<RelativePose<Pose>> edges;
  std::vector<std::uint32_t> begin, neighbors;
};

template <class Pose>
Adjacency<Pose> adjacency_of(Graph& graph) {
  Adjacency<Pose> adjacency;
  for (const auto& batch : graph.batches()) {
    auto relative = PoseArray<Pose>::relative(*batch);
    if (adjacency.edges.empty())
      adjacency.edges = std::move(relative);
    else
      adjacency.edges.insert(adjacency.edges.end(), relative.begin(), relative.end());
  }
  auto& begin = adjacency.begin;
  begin.assign(PoseArray<Pose>::of(graph.values()).size() + 1, 0);
  for (const auto& edge : adjacency.edges) ++begin[edge.a + 1], ++begin[edge.b + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  adjacency.neighbors.resize(2 * adjacency.edges.size());
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (std::uint32_t e = 0; e < adjacency.edges.size(); ++e) {
    adjacency.neighbors[next[adjacency.edges[e].a]++] = e;
    adjacency.neighbors[next[adjacency.edges[e].b]++] = e;
  }
  return adjacency;
}

// Products drift; this takes it out.
Se2 renewed(const Se2& pose) { return {pose.x(), pose.y(), pose.theta()}; }
Se3 renewed(const Se3& pose) { return pose.retract(Se3::Tangent::Zero()); }

// Breadth first from the poses in `queue`, all of them known.
template <class Pose>
void spread(const Adjacency<Pose>& adjacency, std::vector<std::uint32_t> queue,
            std::vector<bool>& known, std::vector<Pose>& poses) {
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const std::uint32_t from = queue[head];
    for (std::uint32_t n = adjacency.begin[from]; n < adjacency.begin[from + 1]; ++n) {
      const RelativePose<Pose>& edge = adjacency.edges[adjacency.neighbors[n]];
      const std::uint32_t to = edge.a == from ? edge.b : edge.a;
      if (known[to]) continue;
      poses[to] = renewed(poses[from] * (edge.a == from ? edge.T_a_b : edge.T_a_b.inverse()));
      known[to] = true;
      queue.push_back(to);
    }
  }
}

template <class Pose>
void chain_poses(Graph& graph, const std::vector<bool>& has_start) {
  std::vector<Pose>& poses = PoseArray<Pose>::of(graph.values());
  const auto slot_of = [&](std::uint32_t i) { return graph.slot_of(PoseArray<Pose>::kType, i); };
  std::vector<std::uint32_t> started, waiting;
  std::vector<bool> known(poses.size());
  for (std::uint32_t i = 0; i < poses.size(); ++i) {
    known[i] = has_start[slot_of(i)];
    (known[i] ? started : waiting).push_back(i);
  }
  if (waiting.empty()) return;
  const Adjacency<Pose> adjacency = adjacency_of<Pose>(graph);
  spread(adjacency, std::move(started), known, poses);
  const auto by_id = [&](std::uint32_t a, std::uint32_t b) {
    return graph.variables()[slot_of(a)].id < graph.variables()[slot_of(b)].id;
  };
  if (!std::is_sorted(waiting.begin(), waiting.end(), by_id))
    std::sort(waiting.begin(), waiting.end(), by_id);
  for (const std::uint32_t root : waiting) {
    if (known[root]) continue;
    known[root] = true;
    poses[root] = Pose();
    spread(adjacency, {root}, known, poses);
  }
}

void place_ahead(Values& values, const Variable& pose, const Variable& point) {
  const auto ahead = [](const auto& T_map_body, auto& p_map) {
    p_map = T_map_body * std::decay_t<decltype(p_map)>::UnitX().eval();
  };
  if (pose.type == VariableType::kPose2 && point.type == VariableType::kPoint2) {
    ahead(values.pose2[pose.index], values.point2[point.index]);
  } else if (pose.type == VariableType::kPose3 && point.type == VariableType::kPoint3) {
    ahead(values.pose3[pose.index], values.point3[point.index]);
  }
}

void place_landmarks(Graph& graph, const std::vector<bool>& has_start) {
  std::vector<bool> sees_landmarks;  // by batch
  for (const auto& batch : graph.batches()) {
    const auto signature = batch->signature();
    sees_landmarks.push_back(signature.size() == 2 && !is_pose(signature[1]));
  }
  std::vector<bool> known(has_start);
  for (const bool may_guess : {false, true}) {  // first those that a factor tells
    for (const FactorRef factor : graph.factors()) {
      if (!sees_landmarks[factor.batch]) continue;
      const FactorBatch& batch = *graph.batches()[factor.batch];
      const auto signature = batch.signature();
      const std::uint32_t* indices = &batch.variable_indices()[2 * std::size_t{factor.index}];
      const VariableSlot point = graph.slot_of(signature[1], indices[1]);
      if (known[point]) continue;
      if (may_guess) {
        const VariableSlot pose = graph.slot_of(signature[0], indices[0]);
        place_ahead(graph.values(), graph.variables()[pose], graph.variables()[point]);
      } else if (!batch.predict_last(factor.index, graph.values())) {
        continue;
      }
      known[point] = true;
    }
  }
}

}  // namespace

void chain_start_values(Graph& graph, const std::vector<bool>& has_start) {
  chain_poses<Se2>(graph, has_start);
  chain_poses<Se3>(graph, has_start);
  place_landmarks(graph, has_start);
}

}  // namespace cairn
