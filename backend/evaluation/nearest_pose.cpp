// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/evaluation/nearest_pose.hpp"

#include <algorithm>

namespace cairn {

std::vector<TrajectoryPose> sorted_by_key(const Trajectory& trajectory) {
  std::vector<TrajectoryPose> poses = trajectory.poses;
  std::stable_sort(poses.begin(), poses.end(),
                   [](const TrajectoryPose& a, const TrajectoryPose& b) { return a.key < b.key; });
  return poses;
}

std::size_t nearest_pose(const std::vector<TrajectoryPose>& poses, std::uint64_t key) {
  const auto lower_bound = [&](std::uint64_t wanted) {
    return std::lower_bound(
        poses.begin(), poses.end(), wanted,
        [](const TrajectoryPose& pose, std::uint64_t k) { return pose.key < k; });
  };
  auto after = lower_bound(key);
  if (after == poses.begin()) return 0;
  if (after == poses.end() ||
      key_difference(std::prev(after)->key, key) <= key_difference(after->key, key)) {
    after = lower_bound(std::prev(after)->key);
  }
  return static_cast<std::size_t>(after - poses.begin());
}

}  // namespace cairn
