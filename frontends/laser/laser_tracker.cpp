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

Eigen::Matrix3d information_of(double sigma_m, double sigma_rad) {
  const double m = 1.0 / (sigma_m * sigma_m);
  return Eigen::Vector3d(m, m, 1.0 / (sigma_rad * sigma_rad)).asDiagonal();
}

}  // namespace

TrackedScan LaserTracker::track(const LaserScan& scan) {
  std::vector<SurfacePoint> points = surface_points(scan, options_.points);
  const Expected expected = predict(scan);
  if (keyframes_.empty()) {
    pose_ = scan.T_odom_laser.value_or(Se2());
    add_keyframe(scan, std::move(points), {});
    return {pose_, 0, true, {}};
  }
  PointToLineMatch match = this->match(points, expected);
  motion_ = pose_.inverse() * match.T_map_scan;
  pose_ = match.T_map_scan;
  since_ = since_ * expected.step;
  way_since_ += expected.way;
  const Se2 since = keyframes_.back().T_odom_laser.inverse() * pose_;
  const bool is_keyframe = since.translation().norm() >= options_.keyframe_distance_m ||
                           std::abs(since.theta()) >= options_.keyframe_angle_rad;
  if (is_keyframe) add_keyframe(scan, std::move(points), match);
  return {pose_, keyframes_.size() - 1, is_keyframe, std::move(match)};
}

LaserTracker::Expected LaserTracker::predict(const LaserScan& scan) {
  const std::optional<Se2> before = std::exchange(wheel_, scan.T_odom_laser);
  const bool guessed = !before || !wheel_;
  const Se2 step = guessed ? motion_ : before->inverse() * *wheel_;
  const double m = step.translation().norm(), rad = std::abs(step.theta());
  const double way = OdometryNoise::way(step);
  if (!guessed)
    return {step, guessed,
            information_of(options_.least_m + options_.odometry_m * m,
                           options_.least_rad + options_.odometry_rad * rad),
            way};
  const MotionGuessOptions& guess = options_.guess;
  return {step, guessed,
          information_of(guess.least_m + guess.share * m, guess.least_rad + guess.share * rad),
          way + guess.way};
}

PointToLineMatch LaserTracker::match(const std::vector<SurfacePoint>& points,
                                     const Expected& expected) {
  PointToLineOptions matching = options_.matching;
  matching.start_information = expected.information;
  PointToLineMatch near = match_point_to_line(*submap_, points, pose_ * expected.step, matching);
  if (!expected.guessed) return near;
  const MotionGuessOptions& guess = options_.guess;
  const auto lines = std::count_if(points.begin(), points.end(),
                                   [](const SurfacePoint& p) { return !p.normal.isZero(); });
  if (near.inliers >= guess.least_inliers * static_cast<double>(lines)) return near;
  if (!submap_grid_)
    submap_grid_.emplace(
        std::vector<SurfacePoint>(submap_->points().begin(), submap_->points().end()), guess.grid);
  const auto found = match_correlative(*submap_grid_, points, pose_ * expected.step, guess.window,
                                       guess.least_score);
  if (!found) return near;
  PointToLineMatch far = match_point_to_line(*submap_, points, found->T_map_scan, matching);
  return far.inliers > near.inliers ? far : near;
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
  submap_grid_.reset();
}

}  // namespace cairn
