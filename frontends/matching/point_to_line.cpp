// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/matching/point_to_line.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "frontends/matching/match_evidence.hpp"

namespace cairn {

PointToLineMatch match_point_to_line(const PointMap& map, const std::vector<SurfacePoint>& scan,
                                     const Se2& start, const PointToLineOptions& options) {
  PointToLineMatch match;
  match.T_map_scan = start;
  double reach = options.first_reach_m;
  for (int step = 0; step < options.iterations; ++step) {
    const Se2& T = match.T_map_scan;
    MatchEvidence evidence(std::max(2.0 * options.sigma_m, 0.33 * reach));
    match.matched = match.inliers = 0;
    for (const SurfacePoint& point : scan) {
      if (point.normal.isZero()) continue;
      const Eigen::Vector2d p = T * point.position;
      const SurfacePoint* const on = map.nearest(p, T.rotation() * point.normal, reach);
      if (on == nullptr) continue;
      const double r = on->normal.dot(p - on->position) - on->to_line_m;
      evidence.add(point, *on, T, r);
      ++match.matched;
      if (std::abs(r) <= 3.0 * options.sigma_m) ++match.inliers;
    }
    const MatchEvidence::Seen seen = evidence.seen();
    match.information = evidence.information(seen);
    match.free = seen.free;
    match.free_direction = seen.free_direction;
    const double variance = options.sigma_m * options.sigma_m;
    const Eigen::Matrix3d& P = seen.projection;
    Eigen::Matrix3d A = P.transpose() * evidence.hessian() * P / variance;
    A += options.start_information;
    A.diagonal().array() += 1e-9 * (1.0 + A.trace());
    const Eigen::Vector3d from_start = (start.inverse() * T).log();
    const Eigen::Vector3d b =
        P.transpose() * evidence.gradient() / variance + options.start_information * from_start;
    const Eigen::Vector3d dx = -A.ldlt().solve(b);
    if (!dx.allFinite()) return match;
    match.T_map_scan = T.retract(dx);
    const bool small = dx.head<2>().norm() < 1e-5 && std::abs(dx.z()) < 1e-5;
    if (small && reach <= options.last_reach_m) {
      match.converged = true;
      break;
    }
    reach = std::max(options.last_reach_m, small ? options.last_reach_m : 0.7 * reach);
  }
  return match;
}

}  // namespace cairn
