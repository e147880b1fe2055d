// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/laser/laser_loop_closer.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "frontends/matching/match_evidence.hpp"

namespace cairn {
namespace {

// The keyframes of a submap and the scan share lines, and what is wrong with these: measured on the
// simulated building over 60 seeds.
constexpr double kSharedLines = 1.65;

double score_of(const LikelihoodGrid& grid, const std::vector<SurfacePoint>& scan,
                const Se2& T_at_scan) {
  std::int64_t sum = 0;
  for (const SurfacePoint& point : scan) {
    const Eigen::Vector2d p = (T_at_scan * point.position - grid.origin()) / grid.cell_m();
    sum += grid.at(0, static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y())));
  }
  return static_cast<double>(sum) / (255.0 * static_cast<double>(scan.size()));
}

// Covariance of what else the scan could be, shifted along the direction that its surfaces fix
// least: half as far as it fits as well. A place may look like the one beside it (after Olson,
// "Real-time correlative scan matching", ICRA 2009, who measures all covariances from scores).
Eigen::Matrix3d covariance_of_rivals(const LikelihoodGrid& grid,
                                     const std::vector<SurfacePoint>& scan,
                                     const PointToLineMatch& match,
                                     const LaserLoopOptions& options) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
  solver.computeDirect(match.information.topLeftCorner<2, 2>());
  const Eigen::Vector2d along = solver.eigenvectors().col(0);
  const double least = score_of(grid, scan, match.T_map_scan) - options.score_margin;
  double farthest = 0.0;
  for (double m = grid.cell_m(); m <= options.farthest_rival_m; m += grid.cell_m())
    for (const double shift : {-m, m})
      if (score_of(grid, scan, match.T_map_scan * Se2(So2(), shift * along)) >= least) farthest = m;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  covariance.topLeftCorner<2, 2>() = 0.25 * farthest * farthest * along * along.transpose();
  return covariance;
}

// The nearest first, and none in the submap of another.
std::vector<std::size_t> near(const std::vector<LoopKeyframe>& keyframes, std::size_t candidates,
                              const Se2& T_map_laser, const LaserLoopOptions& options,
                              std::span<const PoseSigmas> sigmas) {
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t k = 0; k < candidates; ++k) {
    if (!sigmas.empty() && !window_nearby(sigmas[k], options)) continue;
    const double distance =
        (keyframes[k].T_map_laser.translation() - T_map_laser.translation()).norm();
    if (distance <= options.radius_m) ranked.emplace_back(distance, k);
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<std::size_t> chosen;
  for (const auto& [distance, k] : ranked) {
    if (chosen.size() >= options.most_candidates) break;
    if (std::any_of(chosen.begin(), chosen.end(), [&](std::size_t other) {
          return (other > k ? other - k : k - other) <= 2 * options.submap_half;
        }))
      continue;
    chosen.push_back(k);
  }
  return chosen;
}

}  // namespace

std::vector<SurfacePoint> submap_around(const std::vector<LoopKeyframe>& keyframes, std::size_t at,
                                        std::size_t half, std::size_t end) {
  std::vector<SurfacePoint> all;
  const Se2 T_at_map = keyframes[at].T_map_laser.inverse();
  const std::size_t first = at - std::min(at, half), last = std::min(at + half, end - 1);
  for (std::size_t k = first; k <= last; ++k)
    for (const SurfacePoint& point :
         moved(T_at_map * keyframes[k].T_map_laser, *keyframes[k].points))
      all.push_back(point);
  return all;
}

// The candidate lies in its submap with an error of its own; in a free direction the match says
// nothing.
Eigen::Matrix3d loop_information(const PointToLineMatch& match, const Eigen::Matrix3d& rivals,
                                 const Eigen::Matrix3d& candidate,
                                 const LaserLoopOptions& options) {
  const Eigen::Matrix3d J = match.T_map_scan.adjoint();
  Eigen::Matrix3d information = match.information;
  if (!candidate.isZero()) information = parallel_sum(information, J.transpose() * candidate * J);
  const double m = std::pow(options.submap_sigma_m, -2);
  const double rad = std::pow(options.submap_sigma_rad, -2);
  information = kSharedLines * parallel_sum(information, Eigen::Vector3d(m, m, rad).asDiagonal());
  information.diagonal() += Eigen::Vector3d(1e-2, 1e-2, 1e-1);
  return (information.inverse() + rivals).inverse();
}

std::optional<SubmapMatch> match_submap(const std::vector<LoopKeyframe>& keyframes, std::size_t at,
                                        std::size_t end, const std::vector<SurfacePoint>& scan,
                                        const Se2& T_at_scan, const LaserLoopOptions& options) {
  const std::vector<SurfacePoint> submap = submap_around(keyframes, at, options.submap_half, end);
  const LikelihoodGrid grid(submap, options.grid);
  const auto found = match_correlative(grid, scan, T_at_scan, options.window, options.least_score);
  if (!found) return std::nullopt;
  const PointMap map(submap, options.matching.first_reach_m);
  const PointToLineMatch match =
      match_point_to_line(map, scan, found->T_map_scan, options.matching);
  const auto lines = std::count_if(scan.begin(), scan.end(),
                                   [](const SurfacePoint& p) { return !p.normal.isZero(); });
  const double inliers =
      lines > 0 ? static_cast<double>(match.inliers) / static_cast<double>(lines) : 0.0;
  if (inliers < options.least_inliers) return std::nullopt;
  return SubmapMatch{at, match.T_map_scan,
                     loop_information(match, covariance_of_rivals(grid, scan, match, options),
                                      keyframes[at].match_information, options),
                     inliers};
}

std::optional<SearchWindow> window_nearby(const PoseSigmas& sigmas,
                                          const LaserLoopOptions& options) {
  const double m = options.sigmas * sigmas.m;
  const SearchWindow& least = options.least_window;
  const SearchWindow& most = options.window;
  if (std::max(least.x_m, least.y_m) + m > std::min(most.x_m, most.y_m)) return std::nullopt;
  return SearchWindow{least.x_m + m, least.y_m + m,
                      std::min(least.angle_rad + options.sigmas * sigmas.rad, most.angle_rad)};
}

std::vector<SubmapMatch> match_near(const std::vector<LoopKeyframe>& keyframes,
                                    std::size_t candidates, std::size_t end,
                                    const LoopKeyframe& scan, const LaserLoopOptions& options,
                                    std::span<const PoseSigmas> sigmas) {
  std::vector<SubmapMatch> matches;
  for (const std::size_t at : near(keyframes, candidates, scan.T_map_laser, options, sigmas)) {
    const Se2 start = keyframes[at].T_map_laser.inverse() * scan.T_map_laser;
    LaserLoopOptions how = options;
    if (!sigmas.empty()) how.window = *window_nearby(sigmas[at], options);
    if (auto match = match_submap(keyframes, at, end, *scan.points, start, how))
      matches.push_back(std::move(*match));
  }
  return matches;
}

std::vector<LaserLoop> find_loops(const std::vector<LoopKeyframe>& keyframes, std::size_t to,
                                  const LaserLoopOptions& options,
                                  std::span<const PoseSigmas> sigmas) {
  std::vector<LaserLoop> loops;
  if (to < options.least_apart) return loops;
  const std::size_t last = to - options.least_apart;
  for (const SubmapMatch& match : match_near(keyframes, last + 1, last + options.least_apart / 2,
                                             keyframes[to], options, sigmas))
    loops.push_back({match.at, to, match.T_at_scan, match.information});
  return loops;
}

}  // namespace cairn
