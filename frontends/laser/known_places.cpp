// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/laser/known_places.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace cairn {

void KnownPlaces::add_keyframe(const LaserKeyframe& keyframe) {
  const std::size_t newest = map_.size();
  map_.push_back({Se2(), &keyframe.points, keyframe.match_information});
  Se2 step;
  if (newest > 0) {
    step = T_odom_newest_.inverse() * keyframe.T_odom_laser;
    map_[newest].T_map_laser = map_[newest - 1].T_map_laser * step;
  }
  T_odom_newest_ = keyframe.T_odom_laser;
  loops_.add_keyframe(map_, step, keyframe.information, keyframe.left);
  stand_at(newest, T_odom_newest_);
  if (!is_known()) look_around();
}

std::optional<KnownPlace> KnownPlaces::find(const std::vector<SurfacePoint>& points,
                                            const Se2& T_odom_laser) {
  if (!is_known()) return std::nullopt;
  const auto place = recognize(points, T_odom_map_.inverse() * T_odom_laser);
  if (place) {
    stand_at(place->keyframe, T_odom_laser * place->T_keyframe_laser.inverse());
    known_end_ = map_.size();
  } else if (map_.size() - known_end_ >= options_.most_new) {
    agreeing_ = 0;
  }
  return place;
}

// Places beside a way that closed a loop are near along the loop, and not along the way.
void KnownPlaces::stand_at(std::size_t keyframe, const Se2& T_odom_keyframe) {
  T_odom_map_ = T_odom_keyframe;
  seen_ = loops_.drift().paths_from(keyframe);
  for (std::size_t k = 0; k < map_.size(); ++k) map_[k].T_map_laser = seen_[k].T_from_it;
}

// A match that could as well be elsewhere, as in a corridor, proves nothing either way.
void KnownPlaces::look_around() {
  const std::size_t newest = map_.size() - 1;
  std::vector<LaserLoop> loops = find_loops(map_, newest, options_.search, loops_.sigmas());
  if (loops.empty()) loops = loops_.find(map_, options_.search);
  loops_.add_loops(loops);
  const auto here = std::find_if(loops.begin(), loops.end(),
                                 [&](const LaserLoop& loop) { return loop.to == newest; });
  if (here == loops.end()) {
    agreeing_ = 0;
    return;
  }
  if (!is_sure(here->information)) return;
  const Se2 expected = map_[here->from].T_map_laser.inverse() * map_[newest].T_map_laser;
  const Se2 apart = expected.inverse() * here->T_from_to;
  const bool agrees = apart.translation().norm() <= options_.agree_m &&
                      std::abs(apart.theta()) <= options_.agree_rad;
  agreeing_ = agrees ? agreeing_ + 1 : 1;
  if (!is_known()) return;
  known_end_ = map_.size();
  stand_at(newest, T_odom_newest_);
}

std::optional<KnownPlace> KnownPlaces::recognize(const std::vector<SurfacePoint>& points,
                                                 const Se2& T_map_laser) const {
  const auto at = nearest(T_map_laser);
  if (!at) return std::nullopt;
  const Se2 T_at_laser = map_[*at].T_map_laser.inverse() * T_map_laser;
  const Eigen::Matrix3d J = T_at_laser.inverse().adjoint();
  PointToLineOptions matching = options_.search.matching;
  matching.start_information =
      (J * seen_[*at].covariance * J.transpose() + options_.told).inverse();
  const PointToLineMatch match = match_point_to_line(
      PointMap(surfaces(*at), matching.first_reach_m), points, T_at_laser, matching);
  const auto lines = std::count_if(points.begin(), points.end(),
                                   [](const SurfacePoint& p) { return !p.normal.isZero(); });
  if (match.inliers < options_.least_known * static_cast<double>(lines) ||
      !is_sure(match.information + matching.start_information))
    return std::nullopt;
  return KnownPlace{*at, match.T_map_scan};
}

// Not the newest one, which the next is tied to by its step.
std::optional<std::size_t> KnownPlaces::nearest(const Se2& T_map_laser) const {
  std::optional<std::size_t> nearest;
  double least = 1.0;
  for (std::size_t k = 0; k < std::min(known_end_, map_.size() - 1); ++k) {
    const Se2 apart = map_[k].T_map_laser.inverse() * T_map_laser;
    const double far = std::hypot(apart.translation().norm() / options_.near_m,
                                  apart.theta() / options_.near_rad);
    if (far >= least) continue;
    least = far;
    nearest = k;
  }
  return nearest;
}

std::vector<SurfacePoint> KnownPlaces::surfaces(std::size_t keyframe) const {
  return submap_around(map_, keyframe, options_.search.submap_half, map_.size());
}

bool KnownPlaces::is_sure(const Eigen::Matrix3d& information) const {
  const Eigen::Matrix3d covariance = information.inverse();
  return covariance.topLeftCorner<2, 2>().trace() <= options_.least_sure_m * options_.least_sure_m;
}

}  // namespace cairn
