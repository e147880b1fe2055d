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

}  // namespace cairn
