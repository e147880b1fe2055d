// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/laser/laser_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "frontends/matching/match_evidence.hpp"

namespace cairn {
namespace {

// Neighboring keyframes are matched with mostly the same lines, so they share what is wrong with
// these: measured on the simulated building over 20 seeds.
constexpr double kSharedLines = 1.27;

}  // namespace

TrackedScan LaserTracker::track(const LaserScan& scan) {
  std::vector<SurfacePoint> points = surface_points(scan, options_.points);
  const Se2 step = predict(scan);
  if (keyframes_.empty()) {
    pose_ = scan.T_odom_laser.value_or(Se2());
    add_keyframe(scan, std::move(points), {});
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
  since_ = since_ * step;
  way_since_ += OdometryNoise::way(step);
  const Se2 since = keyframes_.back().T_odom_laser.inverse() * pose_;
  const bool is_keyframe = since.translation().norm() >= options_.keyframe_distance_m ||
                           std::abs(since.theta()) >= options_.keyframe_angle_rad;
  if (is_keyframe) add_keyframe(scan, std::move(points), match);
  return {pose_, keyframes_.size() - 1, is_keyframe, std::move(match)};
}

Se2 LaserTracker::predict(const LaserScan& scan) {
  Se2 step;
  if (scan.T_odom_laser && wheel_) step = wheel_->inverse() * *scan.T_odom_laser;
  wheel_ = scan.T_odom_laser;
  return step;
}

// Both ends of the step were matched with the same surfaces, each with its own error; odometry
// holds the directions that these do not show.
Eigen::Matrix3d LaserTracker::step_information(const PointToLineMatch& match) {
  const Keyframe& before = keyframes_.back();
  const Se2 step = before.T_odom_laser.inverse() * pose_;
  Eigen::Matrix3d surfaces = match.information;
  if (keyframes_.size() > 1) {
    const Eigen::Matrix3d J = step.adjoint();  // of an error here, as one there
    surfaces = kSharedLines * parallel_sum(surfaces, J.transpose() * before.match_information * J);
  }
  if (match.free == 0 && match.converged) odometry_.learn(since_, step, surfaces);
  return surfaces + odometry_.information(way_since_);
}

void LaserTracker::add_keyframe(const LaserScan& scan, std::vector<SurfacePoint> points,
                                const PointToLineMatch& match) {
  const Eigen::Matrix3d information =
      keyframes_.empty() ? Eigen::Matrix3d::Zero() : step_information(match);
  keyframes_.push_back({scan.stamp_ns, pose_, std::move(points), information, match.information});
  since_ = Se2();
  way_since_ = 0.0;
  std::vector<SurfacePoint> all;
  const std::size_t first =
      keyframes_.size() - std::min(keyframes_.size(), options_.submap_keyframes);
  for (std::size_t k = first; k < keyframes_.size(); ++k)
    for (const SurfacePoint& point : moved(keyframes_[k].T_odom_laser, keyframes_[k].points))
      all.push_back(point);
  submap_.emplace(std::move(all), options_.matching.first_reach_m);
}

}  // namespace cairn
