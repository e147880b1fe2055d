// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "frontends/matching/scan_points.hpp"

namespace cairn {

/// Surface points that are asked for their nearest ones: a grid of buckets over their extent.
class PointMap {
 public:
  /// Asked for neighbors up to `reach_m` away.
  PointMap(std::vector<SurfacePoint> points, double reach_m);

  /// The nearest one with a normal within reach whose normal is within 60 deg of `normal` (zero:
  /// any); null: none.
  [[nodiscard]] const SurfacePoint* nearest(const Eigen::Vector2d& position,
                                            const Eigen::Vector2d& normal, double within_m) const;
  [[nodiscard]] std::span<const SurfacePoint> points() const { return points_; }
  /// Neighbors further away than this must not be asked for.
  [[nodiscard]] double reach_m() const { return reach_; }

 private:
  double reach_, cell_;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint32_t> begin_;  ///< by cell, into points_
  std::vector<SurfacePoint> points_;  ///< by cell
};

}  // namespace cairn
