// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/evaluation/relations.hpp"

#include <optional>

#include "cairn/evaluation/nearest_pose.hpp"

namespace cairn {

Result<RelationErrors> relation_errors(const Relations& reference, const Trajectory& estimate,
                                       std::uint64_t max_difference_ns) {
  if (estimate.format != TrajectoryFormat::kTum) {
    return Error{ErrorCode::kBadInput,
                 "has no time stamps, which relations are matched by; give a TUM file",
                 estimate.name};
  }
  const std::vector<TrajectoryPose> poses = sorted_by_key(estimate);
  const auto pose_at = [&](std::uint64_t stamp_ns) -> const Se3* {
    if (poses.empty()) return nullptr;
    const TrajectoryPose& pose = poses[nearest_pose(poses, stamp_ns)];
    return key_difference(pose.key, stamp_ns) <= max_difference_ns ? &pose.T_world_body : nullptr;
  };
  RelationErrors result;
  for (std::size_t i = 0; i < reference.relations.size(); ++i) {
    const Relation& relation = reference.relations[i];
    const Se3 *from = pose_at(relation.from_ns), *to = pose_at(relation.to_ns);
    if (from && to) {
      result.errors.add(relation.T_from_to.inverse() * (from->inverse() * *to), i);
    } else {
      result.unmatched.push_back(i);
    }
  }
  return result;
}

}  // namespace cairn
