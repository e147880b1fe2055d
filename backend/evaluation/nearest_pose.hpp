// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "cairn/io/trajectory.hpp"

namespace cairn {

/// By key; of poses with the same key the first in the file comes first.
std::vector<TrajectoryPose> sorted_by_key(const Trajectory& trajectory);

inline std::uint64_t key_difference(std::uint64_t a, std::uint64_t b) {
  return a < b ? b - a : a - b;
}

/// Index of the pose with the nearest key; of equally near ones the earlier, of equal keys the
/// first. `poses` are sorted and not empty.
std::size_t nearest_pose(const std::vector<TrajectoryPose>& poses, std::uint64_t key);

}  // namespace cairn
