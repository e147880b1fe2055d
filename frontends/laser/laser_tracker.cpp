// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/laser/laser_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cairn {

TrackedScan LaserTracker::track(const LaserScan& scan) {
  std::vector<SurfacePoint> points = surface_points(scan, options_.points);
  Se2 step;
  if (scan.T_odom_laser && wheel_) step = wheel_->inverse() * *scan.T_odom_laser;
  wheel_ = scan.T_odom_laser;
  if (keyframes_.empty()) {
    pose_ = scan.T_odom_laser.value_or(Se2());
    add_keyframe(scan, std::move(points), pose_, Eigen::Matrix3d::Zero());
    return {pose_, 0, true, {}};
  }
  PointToLineOptions matching = options_.matching;
  const double sigma_m = options_.least_m + options_.odometry_m * step.translation().norm();
  const double sigma_rad = options_.least_rad + options_.odometry_rad * std::abs(step.theta());
  matching.start_information = Eigen::Vector3d(1.0 / (sigma_m * sigma_m), 1.0 / (sigma_m * sigma_m),
                                               1.0 / (sigma_rad * sigma_rad))
                                   .asDiagonal();
  PointToLineMatch match = match_point_to_line(*submap_, points, pose_ * step, matching);
  pose_ = match.T_map_scan;
  const Se2 since = keyframes_.back().T_odom_laser.inverse() * pose_;
  const bool is_keyframe = since.translation().norm() >= options_.keyframe_distance_m ||
                           std::abs(since.theta()) >= options_.keyframe_angle_rad;
  if (is_keyframe)
    add_keyframe(scan, std::move(points), pose_, match.information + matching.start_information);
  return {pose_, keyframes_.size() - 1, is_keyframe, std::move(match)};
}

void LaserTracker::add_keyframe(const LaserScan& scan, std::vector<SurfacePoint> points,
                                const Se2& T, const Eigen::Matrix3d& information) {
  keyframes_.push_back({scan.stamp_ns, T, std::move(points), information});
  std::vector<SurfacePoint> all;
  const std::size_t first =
      keyframes_.size() - std::min(keyframes_.size(), options_.submap_keyframes);
  for (std::size_t k = first; k < keyframes_.size(); ++k)
    for (const SurfacePoint& point : moved(keyframes_[k].T_odom_laser, keyframes_[k].points))
      all.push_back(point);
  submap_.emplace(std::move(all), options_.matching.first_reach_m);
}

}  // namespace cairn
