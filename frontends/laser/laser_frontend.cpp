// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/laser/laser_frontend.hpp"

#include <utility>

#include "cairn/factors/build_transaction.hpp"

namespace cairn {

Result<void> LaserFrontend::start(FrontendContext& context) {
  context_ = &context;
  return {};
}

NodeId LaserFrontend::node(std::size_t keyframe) const {
  return {{context_->robot(), context_->epoch()}, keyframe};
}

Result<void> LaserFrontend::process(const SensorFrame& frame) {
  const auto& scan = std::get<LaserScan>(frame);
  const TrackedScan tracked = tracker_.track(scan);
  const LaserTracker::Keyframe& keyframe = tracker_.keyframes()[tracked.keyframe];
  context_->localize({scan.stamp_ns, node(tracked.keyframe),
                      keyframe.T_odom_laser.inverse() * tracked.T_odom_laser});
  return tracked.is_keyframe ? add_keyframe(scan) : Result<void>();
}

Result<void> LaserFrontend::add_keyframe(const LaserScan& scan) {
  const auto& keyframes = tracker_.keyframes();
  const std::size_t newest = keyframes.size() - 1;
  Se2 step;
  Se2 T_map_laser = keyframes[newest].T_odom_laser;
  if (newest > 0) {
    step = keyframes[newest - 1].T_odom_laser.inverse() * keyframes[newest].T_odom_laser;
    T_map_laser = map_.back().T_map_laser * step;
  }
  map_.push_back({T_map_laser, &keyframes[newest].points});
  if (newest >= context_->keyframes_before()) {
    Transaction transaction;
    add_pose(transaction, node(newest), keyframes[newest].T_odom_laser, scan.stamp_ns);
    transaction.variables.back().odometry = transaction.variables.back().start;
    if (newest > 0)
      add_between(transaction, node(newest - 1), node(newest), step,
                  options_.independent_share * keyframes[newest].information,
                  FactorKind::kOdometry);
    if (auto sent = context_->submit_keyframe(std::move(transaction)); !sent) return sent;
  }
  return context_->roles().loop_closer ? close_loops(newest) : Result<void>();
}

Result<void> LaserFrontend::close_loops(std::size_t keyframe) {
  Transaction transaction;
  for (const LaserLoop& loop : find_loops(map_, keyframe, options_.loops))
    add_between(transaction, node(loop.from), node(loop.to), loop.T_from_to,
                options_.independent_share * loop.information, FactorKind::kLoop);
  if (transaction.factors.empty()) return {};
  return context_->submit_loops(std::move(transaction));
}

// What is newer than the snapshot keeps its place relative to the last pose that is in it.
void LaserFrontend::on_snapshot(const MapSnapshot& snapshot) {
  const OdometryFrame own{context_->robot(), context_->epoch()};
  for (const PoseChunk& chunk : snapshot.changed) {
    if (chunk.frame != own) continue;
    for (const PoseEstimate& pose : chunk.poses) {
      if (pose.index >= map_.size()) continue;
      map_[pose.index].T_map_laser =
          Se2(pose.T_map_body[0], pose.T_map_body[1], pose.T_map_body[2]);
      optimized_ = std::max(optimized_, static_cast<std::size_t>(pose.index) + 1);
    }
  }
  const auto& keyframes = tracker_.keyframes();
  for (std::size_t k = std::max<std::size_t>(optimized_, 1); k < map_.size(); ++k)
    map_[k].T_map_laser = map_[k - 1].T_map_laser *
                          (keyframes[k - 1].T_odom_laser.inverse() * keyframes[k].T_odom_laser);
}

}  // namespace cairn
