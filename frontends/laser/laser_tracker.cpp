// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/laser/laser_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "frontends/matching/match_evidence.hpp"

namespace cairn {
namespace {

// Neighboring keyframes are matched with mostly the same lines, so they share what is wrong with
// these: measured on the simulated building over 40 seeds.
constexpr double kSharedLines = 1.25;

Eigen::Matrix3d information_of(double sigma_m, double sigma_rad) {
  const double m = 1.0 / (sigma_m * sigma_m);
  return Eigen::Vector3d(m, m, 1.0 / (sigma_rad * sigma_rad)).asDiagonal();
}

bool same(const Se2& a, const Se2& b) {
  return a.translation() == b.translation() && a.theta() == b.theta();
}

}  // namespace

TrackedScan LaserTracker::track(const LaserScan& scan) {
  std::vector<SurfacePoint> points = surface_points(scan, options_.points);
  Expected expected = predict(scan);
  if (keyframes_.empty()) {
    pose_ = scan.T_odom_laser.value_or(Se2());
    wheel_at_ = pose_;
    add_keyframe(scan, std::move(points), {});
    return {pose_, 0, Se2(), true, {}};
  }
  PointToLineMatch match = this->match(points, expected);
  sees_ = match.free == 0;
  motion_ = pose_.inverse() * match.T_map_scan;
  pose_ = match.T_map_scan;
  if (!expected.late) wheel_at_ = pose_;
  since_ = since_ * expected.step;
  way_since_ += expected.way;
  guessed_since_ = guessed_since_ || expected.guessed;
  if (at_.is_known_place) {
    detour_way_ += expected.way;
    blind_way_ = sees_ ? 0.0 : blind_way_ + expected.way;
  }
  const Se2 since = due_from_.inverse() * pose_;
  const bool is_due = since.translation().norm() >= options_.keyframe_distance_m ||
                      std::abs(since.theta()) >= options_.keyframe_angle_rad;
  const auto place =
      is_due && options_.know_places && wheel_ ? places_.find(points, pose_) : std::nullopt;
  if (place) stand_at(*place);
  const bool is_keyframe = is_due && !place;
  if (is_keyframe) add_keyframe(scan, std::move(points), match);
  return {pose_, at_.keyframe, at_.T_odom_keyframe.inverse() * pose_, is_keyframe,
          std::move(match)};
}

// Odometry that says exactly the same again, of a robot that scans have just shown moving, is late:
// what it says next counts from where it stopped. Where scans leave a direction free, it stands.
LaserTracker::Expected LaserTracker::predict(const LaserScan& scan) {
  const std::optional<Se2> before = wheel_;
  wheel_ = scan.T_odom_laser;
  if (!before || !wheel_) return guess_motion();
  const Se2 told = before->inverse() * *wheel_;
  const MotionGuessOptions& guess = options_.guess;
  const bool moves =
      motion_.translation().norm() > guess.least_m || std::abs(motion_.theta()) > guess.least_rad;
  if (moves && sees_ && same(*before, *wheel_)) {
    Expected expected = guess_motion();
    expected.late = true;
    return expected;
  }
  return {pose_.inverse() * wheel_at_ * told, false, false,
          information_of(options_.least_m + options_.odometry_m * told.translation().norm(),
                         options_.least_rad + options_.odometry_rad * std::abs(told.theta())),
          OdometryNoise::way(told)};
}

LaserTracker::Expected LaserTracker::guess_motion() const {
  const MotionGuessOptions& guess = options_.guess;
  return {motion_, true, false,
          information_of(guess.least_m + guess.share * motion_.translation().norm(),
                         guess.least_rad + guess.share * std::abs(motion_.theta())),
          OdometryNoise::way(motion_) + guess.way};
}

// Odometry stands unless surfaces fit clearly better elsewhere, with hardly one that does not: few
// beams find a better fit somewhere in any room.
PointToLineMatch LaserTracker::match(const std::vector<SurfacePoint>& points, Expected& expected) {
  const auto lines = std::count_if(points.begin(), points.end(),
                                   [](const SurfacePoint& p) { return !p.normal.isZero(); });
  const double enough = options_.guess.least_inliers * static_cast<double>(lines);
  PointToLineOptions matching = options_.matching;
  matching.start_information = expected.information;
  const Se2 told = pose_ * expected.step;
  PointToLineMatch best = match_point_to_line(*submap_, points, told, matching);
  if (best.inliers >= enough) return best;
  const bool late = expected.late;
  const Expected guess = guess_motion();
  matching.start_information = guess.information;
  const auto try_from = [&](const Se2& start) {
    PointToLineMatch other = match_point_to_line(*submap_, points, start, matching);
    const bool is_clean = other.inliers >= options_.guess.clean * other.matched;
    const bool is_better = expected.guessed
                               ? other.inliers > best.inliers
                               : is_clean && other.inliers > options_.guess.clearly * best.inliers;
    if (!is_better) return;
    best = std::move(other);
    expected = guess;
    expected.late = late;
  };
  const bool wheels = !expected.guessed;
  if (wheels) try_from(pose_ * guess.step);
  if (best.inliers < enough) try_around(points, pose_ * guess.step, try_from);
  if (best.inliers < enough && wheels) try_around(points, told, try_from);
  return best;
}

void LaserTracker::try_around(const std::vector<SurfacePoint>& points, const Se2& T_odom_laser,
                              const std::function<void(const Se2&)>& try_from) {
  if (!submap_grid_)
    submap_grid_.emplace(
        std::vector<SurfacePoint>(submap_->points().begin(), submap_->points().end()),
        options_.guess.grid);
  const auto found = match_correlative(*submap_grid_, points, T_odom_laser, options_.guess.window,
                                       options_.guess.least_score, options_.guess.most_lookups);
  if (found) try_from(found->T_map_scan);
}

// Both ends of the step were matched with the same surfaces, each with its own error; odometry
// holds the directions that these do not show.
Eigen::Matrix3d LaserTracker::step_information(const PointToLineMatch& match) {
  const LaserKeyframe& before = keyframes_.back();
  const Se2 step = before.T_odom_laser.inverse() * pose_;
  Eigen::Matrix3d surfaces = match.information;
  if (keyframes_.size() > 1) {
    const Eigen::Matrix3d J = step.adjoint();  // of an error here, as one there
    surfaces = kSharedLines * parallel_sum(surfaces, J.transpose() * before.match_information * J);
  }
  if (match.free == 0 && match.converged && !guessed_since_)
    odometry_.learn(since_, step, surfaces);
  return surfaces + odometry_.information(way_since_);
}

void LaserTracker::add_keyframe(const LaserScan& scan, std::vector<SurfacePoint> points,
                                const PointToLineMatch& match) {
  LaserKeyframe keyframe{scan.stamp_ns, pose_, std::move(points), Eigen::Matrix3d::Zero(),
                         match.information};
  if (at_.is_known_place) {
    keyframe.left = way_here(match);
    keyframe.information = odometry_.information_of_detour(detour_way_);
    first_after_known_ = keyframes_.size();
  } else if (!keyframes_.empty()) {
    keyframe.information = step_information(match);
  }
  keyframes_.push_back(std::move(keyframe));
  if (options_.know_places) places_.add_keyframe(keyframes_.back());
  at_ = {keyframes_.size() - 1, pose_, false};
  detour_way_ = 0.0;
  begin_stretch();
}

// Surfaces of the place are put where this scan sees them, so its pose in the odometry frame goes
// on without a jump.
void LaserTracker::stand_at(const KnownPlace& place) {
  if (!at_.is_known_place) detour_way_ = way_since_;
  at_ = {place.keyframe, pose_ * place.T_keyframe_laser.inverse(), true};
  known_ = moved(at_.T_odom_keyframe, places_.surfaces(place.keyframe));
  first_after_known_ = keyframes_.size();
  begin_stretch();
}

void LaserTracker::begin_stretch() {
  due_from_ = pose_;
  since_ = Se2();
  way_since_ = 0.0;
  guessed_since_ = false;
  renew_submap();
}

// Odometry holds what no surface has fixed since then.
LaserLoop LaserTracker::way_here(const PointToLineMatch& match) const {
  const LaserKeyframe& from = keyframes_[at_.keyframe];
  Eigen::Matrix3d information =
      loop_information(match, Eigen::Matrix3d::Zero(), from.match_information, {});
  if (match.free > 0) information += odometry_.information(blind_way_);
  return {at_.keyframe, keyframes_.size(), at_.T_odom_keyframe.inverse() * pose_, information};
}

// The last keyframes, and the known place that they began at.
void LaserTracker::renew_submap() {
  const std::size_t newest = keyframes_.size();
  const std::size_t first =
      std::max(first_after_known_, newest - std::min(newest, options_.submap_keyframes));
  if (newest - first_after_known_ >= options_.submap_keyframes) known_.clear();
  std::vector<SurfacePoint> all = known_;
  for (std::size_t k = first; k < newest; ++k)
    for (const SurfacePoint& point : moved(keyframes_[k].T_odom_laser, keyframes_[k].points))
      all.push_back(point);
  submap_.emplace(std::move(all), options_.matching.first_reach_m);
  submap_grid_.reset();
}

}  // namespace cairn
