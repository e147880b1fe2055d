// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/laser/laser_ground_closer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
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

constexpr std::size_t kBearings = 720;

std::size_t bearing_of(const Eigen::Vector2d& p) {
  const double turn = std::atan2(p.y(), p.x()) / (2.0 * std::numbers::pi) + 0.5;
  return static_cast<std::size_t>(turn * kBearings) % kBearings;
}

std::vector<float> ranges_of(const std::vector<SurfacePoint>& points) {
  std::vector<float> ranges(kBearings, 0.0f);
  for (const SurfacePoint& point : points) {
    float& range = ranges[bearing_of(point.position)];
    const auto here = static_cast<float>(point.position.norm());
    if (range == 0.0f || here < range) range = here;
  }
  return ranges;
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
  track.keyframes.insert_or_assign(keyframe.node.index,
                                   store(track, pose->second, std::move(points)));
  return keyframe.is_new ? close_loops(keyframe.node.frame, keyframe.node.index) : Result<void>();
}

// A place looks like what was seen there and on the way there: one sweep sees half of it. How well
// the keyframe lies among them is how well its tracker could know.
LaserGroundCloser::Stored LaserGroundCloser::store(const Track& track, const Se2& T_map_body,
                                                   std::vector<SurfacePoint> points) const {
  std::vector<SurfacePoint> around;
  std::size_t left = options_.described;
  for (auto at = track.keyframes.rbegin(); at != track.keyframes.rend() && left > 0; ++at, --left)
    for (const SurfacePoint& point :
         moved(T_map_body.inverse() * track.poses.at(at->first), at->second.points))
      around.push_back(point);
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  if (!around.empty())
    information = match_point_to_line(PointMap(around, options_.loops.matching.first_reach_m),
                                      points, Se2(), options_.loops.matching)
                      .information;
  around.insert(around.end(), points.begin(), points.end());
  std::vector<float> ranges = ranges_of(points);
  return {std::move(points), describe_place(around), std::move(ranges), information};
}

LaserGroundCloser::View LaserGroundCloser::view(const Track& track) {
  View view;
  for (const auto& [index, stored] : track.keyframes) {
    view.indices.push_back(index);
    view.keyframes.push_back({track.poses.at(index), &stored.points, stored.match_information});
  }
  return view;
}

// The place that fits best of those that look alike.
std::optional<SubmapMatch> LaserGroundCloser::match_anywhere(const Track& track, const View& view,
                                                             const Stored& newest) const {
  std::vector<std::pair<float, std::size_t>> alike;
  for (std::size_t k = 0; k < view.indices.size(); ++k) {
    const float like = similarity(newest.look, track.keyframes.at(view.indices[k]).look);
    if (like >= options_.least_similarity) alike.emplace_back(-like, k);
  }
  std::sort(alike.begin(), alike.end());
  const LaserLoopOptions& how = options_.anywhere;
  std::vector<std::size_t> tried;
  std::optional<SubmapMatch> best;
  for (const auto& [unlike, k] : alike) {
    if (tried.size() >= how.most_candidates) break;
    if (std::any_of(tried.begin(), tried.end(), [&, at = k](std::size_t other) {
          return std::max(at, other) - std::min(at, other) <= 2 * how.submap_half;
        }))
      continue;
    tried.push_back(k);
    auto match = match_submap(view.keyframes, k, view.keyframes.size(), newest.points, Se2(), how);
    if (match && (!best || match->inliers > best->inliers)) best = std::move(match);
  }
  return best;
}

Se2 LaserGroundCloser::pose_of(const NodeId& node) const {
  return tracks_.at(node.frame).poses.at(node.index);
}

// Whether walls of one robot stand where the other looked through: two places that look alike are
// not the same when what is around them contradicts.
bool LaserGroundCloser::is_seen_through(const Sighting& newest) const {
  constexpr double kNear_m = 8.0, kSame_m = 0.3, kBehind_m = 0.6, kHeadOn = 0.4;
  constexpr std::size_t kMostKeyframes = 60, kEveryPoint = 7;
  const auto [first_frame, second_frame] = std::minmax(newest.from.frame, newest.to.frame);
  const Track &first = tracks_.at(first_frame), &second = tracks_.at(second_frame);
  const Se2 T_first_second = LoopStories::first_map_second_map(newest, map());
  std::size_t same = 0, through = 0, place = 0;
  const std::size_t every = second.keyframes.size() / kMostKeyframes + 1;
  for (const auto& [index, stored] : second.keyframes) {
    if (place++ % every != 0) continue;
    const Se2 T_first_body = T_first_second * second.poses.at(index);
    for (const auto& [other_index, other] : first.keyframes) {
      const Se2 T_other_body = first.poses.at(other_index).inverse() * T_first_body;
      if (T_other_body.translation().norm() > kNear_m) continue;
      for (std::size_t i = place % kEveryPoint; i < stored.points.size(); i += kEveryPoint) {
        const Eigen::Vector2d p = T_other_body * stored.points[i].position;
        const double seen = other.ranges_m[bearing_of(p)], range = p.norm();
        const Eigen::Vector2d normal = T_other_body.rotation() * stored.points[i].normal;
        if (seen == 0.0 || range > kNear_m || std::abs(normal.dot(p)) < kHeadOn * range) continue;
        same += std::abs(seen - range) <= kSame_m;
        through += seen - range > kBehind_m;
      }
    }
  }
  return static_cast<double>(through) >
         options_.most_seen_through * static_cast<double>(same + through);
}

LoopStories::Map LaserGroundCloser::map() const {
  return {[this](const NodeId& node) { return pose_of(node); },
          [this](const Sighting& newest) { return is_seen_through(newest); }};
}

void LaserGroundCloser::hear(const Sighting& sighting, Transaction& transaction) {
  const auto frames = std::minmax(sighting.from.frame, sighting.to.frame);
  LoopStories& stories = stories_.try_emplace(frames, options_.stories).first->second;
  for (const Sighting& s : stories.hear(sighting, map()))
    add_between(transaction, s.from, s.to, s.T_from_to, s.information, FactorKind::kLoop);
}

Result<void> LaserGroundCloser::close_loops(const OdometryFrame& frame, std::uint64_t index) {
  const Track& own = tracks_.at(frame);
  const Stored& newest = own.keyframes.at(index);
  const LoopKeyframe scan{own.poses.at(index), &newest.points};
  Transaction transaction;
  for (const auto& [other_frame, other] : tracks_) {
    const View seen = view(other);
    if (other_frame != frame && other.map != own.map) {
      if (const auto match = match_anywhere(other, seen, newest))
        hear({{other_frame, seen.indices[match->at]},
              {frame, index},
              match->T_at_scan,
              match->information},
             transaction);
      continue;
    }
    std::vector<SubmapMatch> matches;
    if (other_frame == frame) {
      const auto at = static_cast<std::size_t>(
          std::lower_bound(seen.indices.begin(), seen.indices.end(), index) - seen.indices.begin());
      for (const LaserLoop& loop : find_loops(seen.keyframes, at, options_.loops))
        matches.push_back({loop.from, loop.T_from_to, loop.information});
    } else {
      matches = match_near(seen.keyframes, seen.keyframes.size(), seen.keyframes.size(), scan,
                           options_.loops);
    }
    for (const SubmapMatch& match : matches)
      add_between(transaction, {other_frame, seen.indices[match.at]}, {frame, index},
                  match.T_at_scan, match.information, FactorKind::kLoop);
  }
  return transaction.factors.empty() ? Result<void>()
                                     : context_->submit_loops(std::move(transaction));
}

}  // namespace cairn
