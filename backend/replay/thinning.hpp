// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "cairn/graph/pose_graph.hpp"

namespace cairn {

struct ThinningOptions {
  /// A pose is redundant where so many newer ones, of other visits, are near it.
  std::size_t visits = 3;
  double radius_m = 1.0, angle_rad = 0.5;  ///< that is near
  std::size_t at_most = 200;               ///< poses at a time
};

/// Old poses of revisited places, and what their measurements say of those that stay.
struct Thinning {
  std::vector<NodeIndex> nodes;    ///< ascending: to be left without factors
  std::vector<NewFactor> factors;  ///< relative poses in place of theirs
  /// Kullback-Leibler divergence of what stays from the exact marginal, in nats, summed over the
  /// poses: what a tree of relative poses cannot say of their neighbors. 0 where a pose only joined
  /// two others.
  double information_lost = 0.0;
};

/// What can be marginalized out of a solved map, so that it does not grow with each visit to the
/// same places. Oldest first, each pose as it stands after those before: its measurements are
/// combined into relative poses of its neighbors along the tree that loses least (maximal
/// information; for a tree the best factors are the exact marginals: Mazuran, Burgard, Tipaldi,
/// "Nonlinear factor recovery for long-term SLAM", IJRR 2016). Taken are only poses that nothing
/// but committed relative poses lead to; never the newest of a frame, what is frozen, nor a pose
/// beside one whose thinning was undone.
///
/// `source`: whose factors those of earlier thinnings are.
Thinning plan_thinning(const PoseGraph& map, const std::string& source,
                       const ThinningOptions& options = {});

}  // namespace cairn
