// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "cairn/geometry/se3.hpp"

namespace cairn {

/// One error per pose or pair of poses.
struct PoseErrors {
  std::vector<double> translation_m;
  std::vector<double> rotation_deg;  ///< 0 .. 180
  std::vector<std::size_t> at;       ///< the pose (the later of a pair) each error belongs to

  /// Appends a difference of poses that belongs to pose `where`.
  void add(const Se3& E, std::size_t where);
};

/// Absolute errors: T_reference^-1 * T_estimate, pose by pose. Equal lengths.
PoseErrors absolute_errors(std::span<const Se3> reference, std::span<const Se3> estimate);

/// How far apart the two poses of a relative error are.
struct PairSpacing {
  double delta = 1.0;
  bool in_metres = false;   ///< delta is a length of path, otherwise a number of poses
  bool consecutive = true;  ///< pairs do not overlap; otherwise every pose begins one
};

using PosePair = std::pair<std::size_t, std::size_t>;

/// Pairs along the estimate. Consecutive by metres: a pose is a mark when the path since the last
/// mark (at first: since pose 0, which is none) is at least delta; neighbouring marks are a pair.
/// All by metres: pose i and the first pose whose path from i is at least delta. By poses: (0, d),
/// (d, 2d), ... or (i, i + d).
std::vector<PosePair> choose_pairs(std::span<const Se3> estimate, const PairSpacing& spacing);

/// Relative errors: (T_ri^-1 T_rj)^-1 (T_ei^-1 T_ej) for each pair (i, j).
PoseErrors relative_errors(std::span<const Se3> reference, std::span<const Se3> estimate,
                           std::span<const PosePair> pairs);

/// Path length from pose 0 to each pose, m.
std::vector<double> path_lengths(std::span<const Se3> poses);

}  // namespace cairn
