// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/laser/laser_far_loops.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <optional>
#include <utility>

namespace cairn {

void LaserFarLoops::add_keyframe(const std::vector<LoopKeyframe>& keyframes,
                                 const Se2& T_before_this, const Eigen::Matrix3d& information,
                                 const std::optional<LaserLoop>& left) {
  drift_.add_keyframe(T_before_this, keyframes.size() > 1 ? Eigen::Matrix3d(information.inverse())
                                                          : Eigen::Matrix3d::Zero());
  if (left) add_loops({*left});
  const Se2 T_this_map = keyframes.back().T_map_laser.inverse();
  std::vector<SurfacePoint> around;
  const std::size_t first = keyframes.size() - std::min(keyframes.size(), options_.described + 1);
  for (std::size_t k = first; k < keyframes.size(); ++k)
    for (const SurfacePoint& point :
         moved(T_this_map * keyframes[k].T_map_laser, *keyframes[k].points))
      around.push_back(point);
  looks_.push_back(describe_place(around));
  sigmas_ = drift_.seen_from(keyframes.size() - 1);
}

void LaserFarLoops::add_loops(const std::vector<LaserLoop>& loops) {
  for (const LaserLoop& loop : loops)
    drift_.add_loop(loop.from, loop.to, loop.T_from_to, loop.information.inverse());
}

// Those that look alike most, none in the submap of another.
std::vector<LaserFarLoops::Candidate> LaserFarLoops::candidates(
    const std::vector<LoopKeyframe>& keyframes, const LaserLoopOptions& nearby) const {
  const LaserLoopOptions& how = options_.search;
  const std::size_t newest = keyframes.size() - 1;
  const Eigen::Vector2d here = keyframes[newest].T_map_laser.translation();
  std::vector<std::pair<float, Candidate>> alike;
  for (std::size_t k = 0; k + how.least_apart <= newest; ++k) {
    if (window_nearby(sigmas_[k], nearby)) continue;
    const double m = std::min(how.sigmas * sigmas_[k].m, options_.most_m);
    if ((keyframes[k].T_map_laser.translation() - here).norm() > how.radius_m + m) continue;
    const float like = similarity(looks_[newest], looks_[k]);
    if (like < options_.least_similarity) continue;
    const double rad = std::min(how.sigmas * sigmas_[k].rad, options_.most_rad);
    alike.push_back({like,
                     {k,
                      {how.window.x_m + m, how.window.y_m + m,
                       std::min(how.window.angle_rad + rad, options_.most_rad)}}});
  }
  std::stable_sort(alike.begin(), alike.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Candidate> chosen;
  for (const auto& [like, candidate] : alike) {
    if (chosen.size() >= how.most_candidates) break;
    const bool is_new = std::none_of(chosen.begin(), chosen.end(), [&](const Candidate& other) {
      return std::max(other.at, candidate.at) - std::min(other.at, candidate.at) <=
             2 * how.submap_half;
    });
    if (is_new) chosen.push_back(candidate);
  }
  return chosen;
}

std::vector<LaserLoop> LaserFarLoops::find(const std::vector<LoopKeyframe>& keyframes,
                                           const LaserLoopOptions& nearby) {
  const std::size_t newest = keyframes.size() - 1;
  std::optional<SubmapMatch> best;
  for (const Candidate& candidate : candidates(keyframes, nearby)) {
    LaserLoopOptions how = options_.search;
    how.window = candidate.window;
    const std::size_t end = newest - how.least_apart + how.least_apart / 2;
    const Se2 start = keyframes[candidate.at].T_map_laser.inverse() * keyframes[newest].T_map_laser;
    auto match = match_submap(keyframes, candidate.at, end, *keyframes[newest].points, start, how);
    if (match && (!best || match->inliers > best->inliers)) best = std::move(match);
  }
  if (!best) return {};
  const LoopStories::Map map{[&](const NodeId& node) { return keyframes[node.index].T_map_laser; }};
  std::vector<LaserLoop> loops;
  for (const Sighting& s :
       stories_.hear({{{}, best->at}, {{}, newest}, best->T_at_scan, best->information}, map))
    loops.push_back({s.from.index, s.to.index, s.T_from_to, s.information});
  return loops;
}

}  // namespace cairn
