// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "cairn/solver/problem.hpp"

namespace cairn {

/// The poses of one type and the relative poses measured between them: what initialization works
/// on.
template <class Pose>
struct RelativePoseGraph {
  explicit RelativePoseGraph(const Problem& problem);

  struct Edge {
    RelativePose<Pose> measured;
    FactorKind kind;
  };
  struct Incidence {
    std::uint32_t edge;
    std::uint32_t other;  ///< the pose at the other end
    bool forward;         ///< this pose is `a` of the edge
  };

  std::vector<Edge> edges;
  std::vector<std::uint32_t> incidence_begin;  ///< by pose index, size + 1
  std::vector<Incidence> incidences;
  std::vector<bool> held;                  ///< by pose index
  std::vector<std::uint32_t> poses_by_id;  ///< pose indices in ascending order of their ids
};

/// Poses reached from the held ones (where a component has none: from its smallest id) along a
/// spanning forest, breadth first. With `odometry_first`, loop closures are used only where
/// odometry does not lead on.
template <class Pose>
void chain_poses(const RelativePoseGraph<Pose>& graph, bool odometry_first,
                 std::vector<Pose>& poses);

}  // namespace cairn
