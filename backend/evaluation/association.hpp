// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "cairn/io/trajectory.hpp"

namespace cairn {

/// The poses two trajectories have in common: reference[i] and estimate[i] belong together, in
/// order of time (TUM), index (KITTI) or id (graph files).
struct Association {
  std::vector<Se3> reference;  ///< T_world_body
  std::vector<Se3> estimate;
  std::size_t unmatched = 0;  ///< poses of the estimate without a partner
};

inline constexpr std::uint64_t kDefaultMaxDifferenceNs = 10'000'000;

/// Pairs poses: by equal index or id, or by time. By time every pose is used at most once: an
/// estimated pose takes the nearest reference pose at most `max_difference_ns` away; of two that
/// want the same one the nearer gets it. Refused when one trajectory has stamps and the other has
/// not, or when nothing matches.
Result<Association> associate(const Trajectory& reference, const Trajectory& estimate,
                              std::uint64_t max_difference_ns = kDefaultMaxDifferenceNs);

}  // namespace cairn
