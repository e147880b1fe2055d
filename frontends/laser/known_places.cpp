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
  const Se2 T_map_laser = T_odom_map_.inverse() * T_odom_laser;
  // Not the newest one, which the next is tied to by its step.
  const auto at = nearest(T_map_laser, std::min(known_end_, map_.size() - 1));
  const auto found = at ? match(*at, points, T_map_laser) : std::nullopt;
  if (found && is_sure(*found)) {
    stand_at(found->at, T_odom_laser * found->T_at_scan.inverse());
    known_end_ = map_.size();
    return KnownPlace{found->at, found->T_at_scan};
  }
  if (map_.size() - known_end_ >= options_.most_new) agreeing_ = 0;
  return std::nullopt;
}

// Places beside a way that closed a loop are near along the loop, and not along the way.
void KnownPlaces::stand_at(std::size_t keyframe, const Se2& T_odom_keyframe) {
  T_odom_map_ = T_odom_keyframe;
  seen_ = loops_.drift().paths_from(keyframe);
  for (std::size_t k = 0; k < map_.size(); ++k) map_[k].T_map_laser = seen_[k].T_from_it;
}

// A match that could as well be elsewhere, as in a corridor, proves nothing either way.
void KnownPlaces::look_around() {
  const LoopKeyframe& newest = map_.back();
  if (map_.size() <= options_.search.least_apart) return;
  const auto at = nearest(newest.T_map_laser, map_.size() - options_.search.least_apart);
  const bool is_beside = at && loops_.sigmas()[*at].m <= options_.most_beside_m;
  const auto found = is_beside ? match(*at, *newest.points, newest.T_map_laser) : search(at);
  if (!found) agreeing_ = 0;
  if (!found || !is_sure(*found)) return;
  const Se2 expected = map_[found->at].T_map_laser.inverse() * newest.T_map_laser;
  const Se2 apart = expected.inverse() * found->T_at_scan;
  const bool agrees = apart.translation().norm() <= options_.agree_m &&
                      std::abs(apart.theta()) <= options_.agree_rad;
  agreeing_ = agrees ? agreeing_ + 1 : 1;
  if (!is_known()) return;
  known_end_ = map_.size();
  stand_at(map_.size() - 1, T_odom_newest_);
}

std::optional<SubmapMatch> KnownPlaces::search(std::optional<std::size_t> nearest) {
  const std::size_t newest = map_.size() - 1;
  const auto window =
      nearest ? window_nearby(loops_.sigmas()[*nearest], options_.search) : std::nullopt;
  std::vector<LaserLoop> loops;
  if (window) {
    LaserLoopOptions how = options_.search;
    how.window = *window;
    const Se2 start = map_[*nearest].T_map_laser.inverse() * map_[newest].T_map_laser;
    const std::size_t end = newest + 1 - how.least_apart / 2;
    if (const auto found = match_submap(map_, *nearest, end, *map_[newest].points, start, how))
      loops.push_back({found->at, newest, found->T_at_scan, found->information});
  } else {
    loops = loops_.find(map_, options_.search);
  }
  loops_.add_loops(loops);
  for (const LaserLoop& loop : loops)
    if (loop.to == newest) return SubmapMatch{loop.from, loop.T_from_to, loop.information};
  return std::nullopt;
}

// From where the path to the keyframe puts it.
std::optional<SubmapMatch> KnownPlaces::match(std::size_t at,
                                              const std::vector<SurfacePoint>& points,
                                              const Se2& T_map_laser) const {
  const Se2 T_at_laser = map_[at].T_map_laser.inverse() * T_map_laser;
  const Eigen::Matrix3d J = T_at_laser.inverse().adjoint();
  PointToLineOptions how = options_.search.matching;
  how.start_information = (J * seen_[at].covariance * J.transpose() + options_.told).inverse();
  const PointToLineMatch match =
      match_point_to_line(PointMap(surfaces(at), how.first_reach_m), points, T_at_laser, how);
  const auto lines = std::count_if(points.begin(), points.end(),
                                   [](const SurfacePoint& p) { return !p.normal.isZero(); });
  const double inliers =
      lines > 0 ? static_cast<double>(match.inliers) / static_cast<double>(lines) : 0.0;
  if (inliers < options_.least_known) return std::nullopt;
  return SubmapMatch{at, match.T_map_scan, match.information + how.start_information, inliers};
}

std::optional<std::size_t> KnownPlaces::nearest(const Se2& T_map_laser, std::size_t end) const {
  std::optional<std::size_t> nearest;
  double least = 1.0;
  for (std::size_t k = 0; k < end; ++k) {
    const Se2 apart = map_[k].T_map_laser.inverse() * T_map_laser;
    const double far =
        std::hypot(apart.translation().norm() / options_.near_m, apart.theta() / options_.near_rad);
    if (far >= least) continue;
    least = far;
    nearest = k;
  }
  return nearest;
}

std::vector<SurfacePoint> KnownPlaces::surfaces(std::size_t keyframe) const {
  return submap_around(map_, keyframe, options_.search.submap_half, map_.size());
}

bool KnownPlaces::is_sure(const SubmapMatch& match) const {
  const Eigen::Matrix3d covariance = match.information.inverse();
  return covariance.topLeftCorner<2, 2>().trace() <= options_.least_sure_m * options_.least_sure_m;
}

}  // namespace cairn
