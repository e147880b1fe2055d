// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "frontends/simulated/floor_plan.hpp"

namespace cairn {

struct RayHit {
  double distance_m;
  std::size_t wall;  ///< index
};

/// Where a ray meets a wall; nothing where it does not, or runs along it.
std::optional<double> meet(const Wall& wall, const Eigen::Vector2d& origin,
                           const Eigen::Vector2d& direction);

/// Finds the first wall that a ray meets. Walls are sorted into a grid, whose cells a ray visits
/// one by one (Amanatides and Woo, "A fast voxel traversal algorithm for ray tracing", 1987).
class RayCaster {
 public:
  explicit RayCaster(std::vector<Wall> walls, double cell_m = 1.0);

  /// The nearest meeting with distance > beyond_m and <= farthest_m; of equally near walls the
  /// first. `direction` is of unit length.
  [[nodiscard]] std::optional<RayHit> cast(const Eigen::Vector2d& origin,
                                           const Eigen::Vector2d& direction, double farthest_m,
                                           double beyond_m = 0.0) const;
  [[nodiscard]] const std::vector<Wall>& walls() const { return walls_; }

 private:
  std::vector<Wall> walls_;
  double cell_m_;
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero(), high_ = Eigen::Vector2d::Zero();
  int columns_ = 0, rows_ = 0;
  std::vector<std::vector<std::uint32_t>> cells_;  // the walls that touch each
};

}  // namespace cairn
