// SPDX-License-Identifier: BSD-3-Clause
#include "server/estimate_publisher.hpp"

#include <algorithm>

#include "cairn/replay/estimate.hpp"

namespace cairn {

EstimatePublisher::Trajectory& EstimatePublisher::trajectory_of(const StoredNode& node) {
  return (is_pose(node.type) ? poses_ : landmarks_)[node.id.frame];
}

void EstimatePublisher::add_new_nodes(const PoseGraph& map) {
  for (auto i = static_cast<NodeIndex>(published_.size()); i < map.nodes.size(); ++i) {
    const StoredNode& node = map.nodes[i];
    Trajectory& trajectory = trajectory_of(node);
    const std::pair<std::uint64_t, NodeIndex> entry(node.id.index, i);
    const auto at = std::lower_bound(trajectory.nodes.begin(), trajectory.nodes.end(), entry);
    const auto place = static_cast<std::size_t>(at - trajectory.nodes.begin());
    trajectory.nodes.insert(at, entry);
    // What is behind an insertion moves into other chunks.
    for (std::size_t k = place / kMaxChunk; k <= (trajectory.nodes.size() - 1) / kMaxChunk; ++k)
      trajectory.dirty.insert(static_cast<std::uint32_t>(k));
    joined_.emplace(node.id.frame, node.id.frame);
  }
}

void EstimatePublisher::mark_moved(const PoseGraph& map) {
  map.estimates.for_each_changed(published_, [&](std::size_t i) {
    const StoredNode& node = map.nodes[i];
    Trajectory& trajectory = trajectory_of(node);
    const auto at = std::lower_bound(trajectory.nodes.begin(), trajectory.nodes.end(),
                                     std::pair(node.id.index, NodeIndex{0}));
    const auto place = static_cast<std::size_t>(at - trajectory.nodes.begin());
    trajectory.dirty.insert(static_cast<std::uint32_t>(place / kMaxChunk));
  });
}

// A robot that composes its odometry onto T_map_odom is where its newest keyframe says.
std::vector<Correction> EstimatePublisher::correct_odometry(const PoseGraph& map) {
  std::vector<Correction> corrections;
  const EstimateRevisions revisions{map.graph_revision, map.solved_revision};
  for (auto& [frame, trajectory] : poses_) {
    const NodeIndex newest = trajectory.nodes.back().second;
    const StoredNode& node = map.nodes[newest];
    if (node.odometry.empty()) continue;
    const Estimate T_odom_body = to_estimate(node.odometry);
    const Estimate& T_map_body = map.estimates[newest];
    const Estimate T_map_odom = map_from_odometry(node.type, T_map_body, T_odom_body);
    std::optional<Correction>& known = trajectory.correction;
    const bool same = known && known->T_map_odom == T_map_odom &&
                      known->stamp_ns == node.stamp_ns && known->map == trajectory.map;
    if (same) continue;
    // Against where the correction that robots use until now puts the same keyframe.
    const PoseDistance jump =
        known ? distance(node.type, product(node.type, known->T_map_odom, T_odom_body), T_map_body)
              : PoseDistance{};
    known = Correction{frame,         trajectory.map,     node.type,         T_map_odom,
                       node.stamp_ns, jump.translation_m, jump.rotation_rad, revisions};
    corrections.push_back(*known);
  }
  return corrections;
}

OdometryFrame EstimatePublisher::root_of(const OdometryFrame& frame) {
  OdometryFrame root = frame;
  while (joined_.at(root) != root) root = joined_.at(root);
  joined_[frame] = root;
  return root;
}

// Frames that committed factors tie together share a map, named after the first of them. They part
// again where these are switched off.
void EstimatePublisher::name_maps(const PoseGraph& map) {
  for (; factors_seen_ < map.factors.size(); ++factors_seen_) {
    const StoredFactor& factor = map.factors[factors_seen_];
    const OdometryFrame& first = map.nodes[factor.nodes[0]].id.frame;
    const bool within = std::all_of(factor.nodes.begin(), factor.nodes.end(), [&](NodeIndex node) {
      return map.nodes[node].id.frame == first;
    });
    if (!within) between_frames_.push_back(factors_seen_);
  }
  for (auto& [frame, parent] : joined_) parent = frame;
  for (const std::size_t place : between_frames_) {
    const StoredFactor& factor = map.factors[place];
    if (!takes_part(factor.state)) continue;
    for (std::size_t k = 1; k < factor.nodes.size(); ++k) {
      const OdometryFrame a = root_of(map.nodes[factor.nodes[0]].id.frame);
      const OdometryFrame b = root_of(map.nodes[factor.nodes[k]].id.frame);
      if (a != b) joined_[std::max(a, b)] = std::min(a, b);
    }
  }
  for (auto* trajectories : {&poses_, &landmarks_}) {
    for (auto& [frame, trajectory] : *trajectories) {
      const OdometryFrame root = root_of(frame);
      const std::string name = root.robot + '/' + std::to_string(root.epoch);
      if (trajectory.map == name) continue;
      trajectory.map = name;
      for (std::size_t k = 0; k <= (trajectory.nodes.size() - 1) / kMaxChunk; ++k)
        trajectory.dirty.insert(static_cast<std::uint32_t>(k));
    }
  }
}

// The chunks that changed; `append` adds one node to a chunk.
template <class Chunk, class Append>
std::vector<Chunk> EstimatePublisher::take_changed(std::map<OdometryFrame, Trajectory>& all,
                                                   const PoseGraph& map, Append append) {
  std::vector<Chunk> chunks;
  for (auto& [frame, trajectory] : all) {
    for (const std::uint32_t number : trajectory.dirty) {
      Chunk chunk;
      chunk.frame = frame;
      chunk.chunk = number;
      chunk.map = trajectory.map;
      const std::size_t first = number * kMaxChunk;
      const std::size_t last = std::min(first + kMaxChunk, trajectory.nodes.size());
      chunk.type = map.nodes[trajectory.nodes[first].second].type;
      for (std::size_t i = first; i < last; ++i)
        append(chunk, trajectory.nodes[i].first, trajectory.nodes[i].second);
      chunks.push_back(std::move(chunk));
    }
    trajectory.dirty.clear();
  }
  return chunks;
}

std::vector<PoseChunk> EstimatePublisher::pose_chunks(const PoseGraph& map) {
  return take_changed<PoseChunk>(
      poses_, map, [&](PoseChunk& chunk, std::uint64_t index, NodeIndex node) {
        chunk.poses.push_back({index, map.nodes[node].stamp_ns, map.estimates[node]});
      });
}

std::vector<LandmarkChunk> EstimatePublisher::landmark_chunks(const PoseGraph& map) {
  return take_changed<LandmarkChunk>(
      landmarks_, map, [&](LandmarkChunk& chunk, std::uint64_t index, NodeIndex node) {
        const Estimate& p = map.estimates[node];
        chunk.landmarks.push_back({index, {p[0], p[1], p[2]}});
      });
}

std::map<OdometryFrame, std::string> EstimatePublisher::map_of_frames() const {
  std::map<OdometryFrame, std::string> names;
  for (const auto& [frame, trajectory] : poses_) names.emplace(frame, trajectory.map);
  return names;
}

void EstimatePublisher::publish(const PoseGraph& map) {
  mark_moved(map);
  add_new_nodes(map);
  name_maps(map);
  const std::vector<Correction> corrections = correct_odometry(map);
  for (const Correction& correction : corrections)
    if (correction.jump_m > jumps_.m || correction.jump_rad > jumps_.rad) jumps_.tell(correction);
  const EstimateRevisions revisions{map.graph_revision, map.solved_revision};
  if (const auto landmarks = landmark_chunks(map); !landmarks.empty())
    transport_.publish_landmarks(revisions, landmarks);
  transport_.publish_poses(revisions, pose_chunks(map));
  for (const Correction& correction : corrections) transport_.publish(correction);
  published_ = map.estimates;
}

}  // namespace cairn
