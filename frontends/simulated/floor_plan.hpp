// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace cairn {

struct Wall {
  Eigen::Vector2d from, to;
  bool glass = false;  ///< now and then a laser sees what is behind
};

/// Walks to and fro along a line of corners, as a disc.
struct Walker {
  std::vector<Eigen::Vector2d> corners;
  double speed_m_s = 1.0, radius_m = 0.25, start_m = 0.0;  ///< start_m: along the way at time 0
};

/// What stands in a building, m, and a tour of it.
struct FloorPlan {
  std::vector<Wall> walls{};
  std::vector<Walker> walkers{};
  std::vector<Eigen::Vector2d> tour{};  ///< corners of a robot's way; it starts in the first
};

/// Where a walker is after a time.
Eigen::Vector2d position_of(const Walker& walker, double time_s);

/// One floor of an office building, 34 m x 22 m: four corridors around a core, the northern one
/// without doors or anything else to see, rooms with furniture, a hall with pillars, glass, three
/// people. The tour of 150 m goes around it once and ends where it has been before.
FloorPlan office_floor();

}  // namespace cairn
