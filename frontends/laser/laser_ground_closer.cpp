// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/laser/laser_ground_closer.hpp"

#include <algorithm>
#include <utility>

#include "cairn/factors/build_transaction.hpp"
#include "cairn/maps/range_scan.hpp"

namespace cairn {
namespace {

// In the body's frame. Payloads of other kinds have none.
std::vector<SurfacePoint> points_of(const RobotKeyframe& keyframe) {
  std::vector<SurfacePoint> all;
  for (const std::string& payload : keyframe.payloads) {
    Result<RangeScan> scan = decode_range_scan(payload);
    if (!scan) continue;
    const LaserScan sweep{.stamp_ns = keyframe.stamp_ns,
                          .first_angle_rad = scan->first_angle_rad,
                          .angle_step_rad = scan->angle_step_rad,
                          .max_range_m = scan->max_range_m,
                          .ranges_m = std::move(scan->ranges_m)};
    for (const SurfacePoint& point : moved(scan->T_body_laser, surface_points(sweep)))
      all.push_back(point);
  }
  return all;
}

}  // namespace

Result<void> LaserGroundCloser::start(FrontendContext& context) {
  context_ = &context;
  return {};
}

Result<void> LaserGroundCloser::process(const SensorFrame& /*frame*/) {
  return Error{ErrorCode::kUsage, "a loop closer alone takes keyframes from a daemon, no scans"};
}

void LaserGroundCloser::on_snapshot(const MapSnapshot& snapshot) {
  for (const PoseChunk& chunk : snapshot.changed) {
    if (chunk.type != VariableType::kPose2) continue;
    Track& track = tracks_[chunk.frame];
    track.map = chunk.map;
    for (const PoseEstimate& pose : chunk.poses)
      track.poses[pose.index] = Se2(pose.T_map_body[0], pose.T_map_body[1], pose.T_map_body[2]);
  }
}

Result<void> LaserGroundCloser::on_keyframe(const RobotKeyframe& keyframe) {
  Track& track = tracks_[keyframe.node.frame];
  const auto pose = track.poses.find(keyframe.node.index);
  std::vector<SurfacePoint> points = points_of(keyframe);
  if (pose == track.poses.end() || points.empty()) return {};
  const PlaceDescriptor look = look_of(track, pose->second, points);
  track.keyframes.insert_or_assign(keyframe.node.index, Stored{std::move(points), look});
  return keyframe.is_new ? close_loops(keyframe.node.frame, keyframe.node.index) : Result<void>();
}

// With what was seen on the way there: one sweep sees half of it.
PlaceDescriptor LaserGroundCloser::look_of(const Track& track, const Se2& T_map_body,
                                           const std::vector<SurfacePoint>& points) const {
  std::vector<SurfacePoint> around = points;
  std::size_t left = options_.described;
  for (auto at = track.keyframes.rbegin(); at != track.keyframes.rend() && left > 0; ++at, --left)
    for (const SurfacePoint& point :
         moved(T_map_body.inverse() * track.poses.at(at->first), at->second.points))
      around.push_back(point);
  return describe_place(around);
}

LaserGroundCloser::View LaserGroundCloser::view(const Track& track) {
  View view;
  for (const auto& [index, stored] : track.keyframes) {
    view.indices.push_back(index);
    view.keyframes.push_back({track.poses.at(index), &stored.points});
  }
  return view;
}

std::vector<SubmapMatch> LaserGroundCloser::match_anywhere(const Track& track, const View& view,
                                                           const Stored& newest) const {
  std::vector<std::pair<float, std::size_t>> alike;
  for (std::size_t k = 0; k < view.indices.size(); ++k) {
    const float like = similarity(newest.look, track.keyframes.at(view.indices[k]).look);
    if (like >= options_.least_similarity) alike.emplace_back(-like, k);
  }
  std::sort(alike.begin(), alike.end());
  const LaserLoopOptions& how = options_.anywhere;
  std::vector<std::size_t> tried;
  std::vector<SubmapMatch> matches;
  for (const auto& [unlike, k] : alike) {
    if (tried.size() >= how.most_candidates) break;
    if (std::any_of(tried.begin(), tried.end(), [&, at = k](std::size_t other) {
          return std::max(at, other) - std::min(at, other) <= 2 * how.submap_half;
        }))
      continue;
    tried.push_back(k);
    if (auto match =
            match_submap(view.keyframes, k, view.keyframes.size(), newest.points, Se2(), how))
      matches.push_back(std::move(*match));
  }
  return matches;
}

Result<void> LaserGroundCloser::close_loops(const OdometryFrame& frame, std::uint64_t index) {
  const Track& own = tracks_.at(frame);
  const Stored& newest = own.keyframes.at(index);
  const LoopKeyframe scan{own.poses.at(index), &newest.points};
  Transaction transaction;
  for (const auto& [other_frame, other] : tracks_) {
    const View seen = view(other);
    std::vector<SubmapMatch> matches;
    if (other_frame == frame) {
      const auto at = static_cast<std::size_t>(
          std::lower_bound(seen.indices.begin(), seen.indices.end(), index) - seen.indices.begin());
      for (const LaserLoop& loop : find_loops(seen.keyframes, at, options_.loops))
        matches.push_back({loop.from, loop.T_from_to, loop.information});
    } else if (other.map == own.map) {
      matches = match_near(seen.keyframes, seen.keyframes.size(), seen.keyframes.size(), scan,
                           options_.loops);
    } else {
      matches = match_anywhere(other, seen, newest);
    }
    for (const SubmapMatch& match : matches)
      add_between(transaction, {other_frame, seen.indices[match.at]}, {frame, index},
                  match.T_at_scan, match.information, FactorKind::kLoop);
  }
  return transaction.factors.empty() ? Result<void>()
                                     : context_->submit_loops(std::move(transaction));
}

}  // namespace cairn
