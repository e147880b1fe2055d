// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/ros/live_trajectory.hpp"

#include <algorithm>
#include <iterator>

namespace cairn {

void LiveTrajectory::add(const Transaction& keyframe) {
  for (const NewVariable& variable : keyframe.variables) {
    const auto& numbers = variable.odometry.empty() ? variable.start : variable.odometry;
    if (variable.node.frame != frame_ || variable.type != VariableType::kPose2 ||
        numbers.size() < 3)
      continue;
    keyframes_.emplace(variable.node.index,
                       Keyframe{variable.stamp_ns, Se2(numbers[0], numbers[1], numbers[2])});
  }
}

bool LiveTrajectory::update(const MapSnapshot& snapshot) {
  bool changed = false;
  for (const PoseChunk& chunk : snapshot.changed) {
    if (chunk.frame != frame_ || chunk.type != VariableType::kPose2) continue;
    for (const PoseEstimate& pose : chunk.poses) {
      const auto keyframe = keyframes_.find(pose.index);
      if (keyframe == keyframes_.end()) continue;
      keyframe->second.T_map_body = Se2(pose.T_map_body[0], pose.T_map_body[1], pose.T_map_body[2]);
      changed = true;
    }
  }
  const auto newest = std::find_if(keyframes_.rbegin(), keyframes_.rend(),
                                   [](const auto& entry) { return entry.second.T_map_body; });
  if (changed && newest != keyframes_.rend())
    T_map_odom_ = *newest->second.T_map_body * newest->second.T_odom_body.inverse();
  return changed;
}

std::optional<Se2> LiveTrajectory::T_map_body(const LocalizedFrame& where) const {
  const auto keyframe = keyframes_.find(where.keyframe.index);
  if (where.keyframe.frame != frame_ || keyframe == keyframes_.end()) return std::nullopt;
  return T_map_body(keyframe->second) * where.T_keyframe_body;
}

}  // namespace cairn
