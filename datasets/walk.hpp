// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "cairn/geometry/se2.hpp"
#include "cairn/geometry/se3.hpp"
#include "datasets/random.hpp"

namespace cairn {

/// Two poses that see the same place; from < to.
struct LoopPair {
  std::uint32_t from, to;
};

/// What a robot truly did: poses T_map_body in order of time, and its loop closures in order of
/// `to`.
template <class Pose>
struct Walk {
  std::vector<Pose> poses;
  std::vector<LoopPair> loops;
};

Walk<Se2> walk_manhattan(std::size_t poses,
                         Random& random);  ///< short blocks, closures to the places around
Walk<Se2> walk_city(std::size_t poses,
                    Random& random);       ///< long streets, closures to the same place, any size
Walk<Se3> walk_sphere(std::size_t poses);  ///< a spiral, closures to the turn below
Walk<Se3> walk_torus(std::size_t poses);   ///< a coil, closures to the previous and the first turn
Walk<Se3> walk_garage(std::size_t poses);  ///< up a ramp and down again in the other lane
Walk<Se3> walk_grid(std::size_t poses,
                    Random& random);  ///< a random walk in a cube, closures to the cells around

/// A closed, winding course of `lap_m` metres, taken at about 1 m per pose; in space it also rises
/// and falls and the body leans. Stations are metres along the course; a lap later they repeat
/// (heights do not quite).
struct Course {
  double lap_m;

  [[nodiscard]] Eigen::Vector3d position(double station) const;
  [[nodiscard]] Eigen::Vector3d ahead(double station) const;
  [[nodiscard]] Walk<Se2> walk2(std::size_t poses) const;
  [[nodiscard]] Walk<Se3> walk3(std::size_t poses) const;
};

/// Body axes x ahead, y left, z up; `ahead` need not be perpendicular to `up`.
Se3 pose_looking(const Eigen::Vector3d& p_map, const Eigen::Vector3d& ahead,
                 const Eigen::Vector3d& up);

}  // namespace cairn
