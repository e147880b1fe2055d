// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "cairn/core/result.hpp"
#include "cairn/graph/graph.hpp"

namespace cairn {

/// Where the simulated robot drives. Plane: kManhattan, kCity. Space: kSphere, kTorus, kGarage,
/// kGrid. kLandmarks is either, as its sensor needs.
enum class World { kManhattan, kCity, kSphere, kTorus, kGarage, kGrid, kLandmarks };

struct SimulationOptions {
  World world = World::kManhattan;
  std::size_t poses = 0;  ///< 0: default_poses(world)
  std::uint64_t seed = 1;
  double noise =
      1.0;  ///< scales every standard deviation; 0: exact measurements, with the information of 1
  double outliers = 0.0;  ///< fraction of the loop closures that are false, 0 .. 1
};

/// A graph as a front-end would have sent it, and what was true. Ids are 0 .. n-1 in order of time.
struct SimulatedGraph {
  Graph graph;                      ///< values: dead reckoning from the true first pose
  Values truth;                     ///< indexed like graph.values()
  std::vector<FactorRef> outliers;  ///< the false loop closures of `graph`

  /// The same graph with its true values.
  [[nodiscard]] Graph true_graph() const;
};

/// Draws a world. Every measurement's error, in the tangent of g2o's error chart, is drawn from its
/// own information, so chi2 of the true values is chi2-distributed with one degree of freedom per
/// measurement row. The same options give the same graph on every machine. Refused: fewer than 2
/// poses, negative noise, a fraction outside 0 .. 1.
Result<SimulatedGraph> simulate(const SimulationOptions& options);

std::size_t default_poses(World world);
std::string_view to_string(World world);
std::optional<World> find_world(std::string_view name);

}  // namespace cairn
