// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/matching/point_to_line.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace cairn {

PointToLineMatch match_point_to_line(const PointMap& map, const std::vector<SurfacePoint>& scan,
                                     const Se2& start, const PointToLineOptions& options) {
  PointToLineMatch match;
  match.T_map_scan = start;
  double reach = options.first_reach_m;
  for (int step = 0; step < options.iterations; ++step) {
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    match.matched = match.inliers = 0;
    const Se2& T = match.T_map_scan;
    const double width = std::max(2.0 * options.sigma_m, 0.33 * reach);
    for (const SurfacePoint& point : scan) {
      if (point.normal.isZero()) continue;
      const Eigen::Vector2d p = T * point.position;
      const SurfacePoint* const on = map.nearest(p, T.rotation() * point.normal, reach);
      if (on == nullptr) continue;
      const double r = on->normal.dot(p - on->position);
      const Eigen::Vector2d n = T.rotation().inverse() * on->normal;  // in the scan's frame
      const Eigen::Vector3d J(n.x(), n.y(),
                              n.y() * point.position.x() - n.x() * point.position.y());
      const double whitened = r / width;
      const double weight = 1.0 / ((1.0 + whitened * whitened) * (1.0 + whitened * whitened));
      H += weight * J * J.transpose();
      g += weight * r * J;
      ++match.matched;
      if (std::abs(r) <= 3.0 * options.sigma_m) ++match.inliers;
    }
    const double variance = options.sigma_m * options.sigma_m;
    match.information = H / variance;
    Eigen::Matrix3d A = match.information + options.start_information;
    A.diagonal().array() += 1e-9 * (1.0 + A.trace());
    const Eigen::Vector3d from_start = (start.inverse() * T).log();
    const Eigen::Vector3d dx =
        -A.ldlt().solve(g / variance + options.start_information * from_start);
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
