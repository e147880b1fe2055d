// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/laser/laser_frontend.hpp"

#include <algorithm>
#include <utility>

#include "cairn/factors/build_transaction.hpp"
#include "cairn/maps/range_scan.hpp"

namespace cairn {

Result<void> LaserFrontend::start(FrontendContext& context) {
  context_ = &context;
  // Keyframes left out are not there to close loops: who finds them, leaves them out.
  LaserTrackerOptions tracker = options_.tracker;
  tracker.know_places = tracker.know_places && context.roles().loop_closer;
  tracker_.emplace(tracker);
  return {};
}

NodeId LaserFrontend::node(std::size_t keyframe) const {
  return {{context_->robot(), context_->epoch()}, keyframe};
}

Result<void> LaserFrontend::process(const SensorFrame& frame) {
  const auto& scan = std::get<LaserScan>(frame);
  tell_missing_odometry(scan);
  const TrackedScan tracked = tracker_->track(scan);
  context_->localize({scan.stamp_ns, node(tracked.keyframe), tracked.T_keyframe_laser});
  if (const auto news = blind_.take(tracked.match, tracked.keyframe)) context_->tell(*news);
  return tracked.is_keyframe ? add_keyframe(scan) : Result<void>();
}

void LaserFrontend::tell_missing_odometry(const LaserScan& scan) {
  if (scan.T_odom_laser || std::exchange(told_missing_odometry_, true)) return;
  context_->tell("the scan stamped " + std::to_string(scan.stamp_ns) +
                 " ns comes without odometry: its motion is guessed from the one before, and so "
                 "for all like it");
}

Result<void> LaserFrontend::stop() {
  if (const std::string summary = blind_.summary(); !summary.empty()) context_->tell(summary);
  return {};
}

Result<void> LaserFrontend::add_keyframe(const LaserScan& scan) {
  const auto& keyframes = tracker_->keyframes();
  const std::size_t newest = keyframes.size() - 1;
  Se2 step;
  Se2 T_map_laser = keyframes[newest].T_odom_laser;
  if (newest > 0) {
    step = keyframes[newest - 1].T_odom_laser.inverse() * keyframes[newest].T_odom_laser;
    T_map_laser = continued(newest);
  }
  if (const auto told = ahead_.extract(newest)) {
    T_map_laser = told.mapped();
    optimized_ = newest + 1;
  }
  map_.push_back({T_map_laser, &keyframes[newest].points, keyframes[newest].match_information});
  if (context_->roles().loop_closer)
    far_loops_.add_keyframe(map_, step, keyframes[newest].information, keyframes[newest].left);
  if (auto sent = submit_keyframe(scan, step); !sent) return sent;
  return context_->roles().loop_closer ? close_loops(newest) : Result<void>();
}

// What a run before this one has submitted is not sent again, but for the first scan where the
// second keyframe, which names it, is still to come.
Result<void> LaserFrontend::submit_keyframe(const LaserScan& scan, const Se2& step) {
  const auto& keyframes = tracker_->keyframes();
  const std::size_t newest = keyframes.size() - 1;
  const std::uint64_t before = context_->keyframes_before();
  if (newest < before && (newest > 0 || before > 1)) return {};
  const Result<std::string> bytes = encode(RangeScan{.first_angle_rad = scan.first_angle_rad,
                                                     .angle_step_rad = scan.angle_step_rad,
                                                     .max_range_m = scan.max_range_m,
                                                     .T_body_laser = Se2(),
                                                     .ranges_m = scan.ranges_m});
  if (!bytes) return bytes.error();
  const Result<ContentHash> hash = context_->send_payload(std::string(kRangeScanPayload), *bytes);
  if (!hash) return hash.error();
  if (newest == 0) first_scan_ = *hash;
  if (newest < before) return {};
  Transaction transaction;
  add_pose(transaction, node(newest), keyframes[newest].T_odom_laser, scan.stamp_ns);
  transaction.variables.back().odometry = transaction.variables.back().start;
  if (newest > 0) {
    add_between(transaction, node(newest - 1), node(newest), step, keyframes[newest].information,
                FactorKind::kOdometry);
    std::vector<ContentHash>& payloads = transaction.factors.back().payloads;
    if (first_scan_) payloads.push_back(*std::exchange(first_scan_, std::nullopt));
    payloads.push_back(*hash);
  }
  return context_->submit_keyframe(std::move(transaction));
}

// A keyframe in the map, by those before it.
Se2 LaserFrontend::continued(std::size_t keyframe) const {
  const LaserKeyframe& here = tracker_->keyframes()[keyframe];
  if (here.left) return map_[here.left->from].T_map_laser * here.left->T_from_to;
  const Se2& T_odom_before = tracker_->keyframes()[keyframe - 1].T_odom_laser;
  return map_[keyframe - 1].T_map_laser * (T_odom_before.inverse() * here.T_odom_laser);
}

// Where none is nearby, the poses may be off too far. A run before this one has sent the loops of
// its keyframes: here they only tell how far poses may be off.
Result<void> LaserFrontend::close_loops(std::size_t keyframe) {
  std::vector<LaserLoop> loops = find_loops(map_, keyframe, options_.loops, far_loops_.sigmas());
  if (loops.empty()) loops = far_loops_.find(map_, options_.loops);
  far_loops_.add_loops(loops);
  if (const auto& left = tracker_->keyframes()[keyframe].left) {
    // The same surfaces again, with the same errors.
    std::erase_if(loops, [&](const LaserLoop& loop) {
      return std::max(loop.from, left->from) - std::min(loop.from, left->from) <=
             2 * options_.loops.submap_half;
    });
    loops.push_back(*left);
  }
  if (keyframe < context_->keyframes_before()) return {};
  Transaction transaction;
  for (const LaserLoop& loop : loops)
    add_between(transaction, node(loop.from), node(loop.to), loop.T_from_to, loop.information,
                FactorKind::kLoop);
  if (transaction.factors.empty()) return {};
  return context_->submit_loops(std::move(transaction));
}

// What is newer than the snapshot keeps its place relative to the last pose that is in it.
void LaserFrontend::on_snapshot(const MapSnapshot& snapshot) {
  const OdometryFrame own{context_->robot(), context_->epoch()};
  for (const PoseChunk& chunk : snapshot.changed) {
    if (chunk.frame != own) continue;
    for (const PoseEstimate& pose : chunk.poses) {
      const Se2 T_map_laser(pose.T_map_body[0], pose.T_map_body[1], pose.T_map_body[2]);
      if (pose.index >= map_.size()) {
        ahead_[pose.index] = T_map_laser;
        continue;
      }
      map_[pose.index].T_map_laser = T_map_laser;
      optimized_ = std::max(optimized_, static_cast<std::size_t>(pose.index) + 1);
    }
  }
  for (std::size_t k = std::max<std::size_t>(optimized_, 1); k < map_.size(); ++k)
    map_[k].T_map_laser = continued(k);
}

}  // namespace cairn
