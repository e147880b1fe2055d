// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cairn/core/result.hpp"
#include "cairn/graph/graph.hpp"

namespace cairn {

/// Where the simulated robot drives. Plane: kManhattan, kCity. Space: kSphere, kTorus, kGarage,
/// kGrid. kLandmarks is either, as its sensor needs.
enum class World { kManhattan, kCity, kSphere, kTorus, kGarage, kGrid, kLandmarks };

/// What kLandmarks measures beside odometry. Plane: kXy .. kPosition. Space: kXyz .. kOffset3.
enum class Sensor {
  kXy,            ///< landmark position, sensor mounted off the body's origin
  kBearing,       ///< landmark direction
  kRange,         ///< landmark distance
  kRangeBearing,  ///< both
  kGnss,          ///< antenna position, with lever arm
  kYaw,           ///< compass
  kPrior,         ///< the whole pose
  kPosition,      ///< the position of the pose
  kOffset,        ///< closures between sensors mounted off the body's origin
  kXyz,
  kRange3,
  kRangeBearing3,
  kGnss3,
  kAltitude,
  kYaw3,
  kGravity,
  kPrior3,
  kOffset3,
};

struct SimulationOptions {
  World world = World::kManhattan;
  std::size_t poses = 0;  ///< 0: default_poses(world)
  std::uint64_t seed = 1;
  /// Scales every standard deviation, 0 .. 10. 0: exact measurements, with the information of 1.
  double noise = 1.0;
  /// Fraction of the loop closures that are false, 0 .. 1. Not for kLandmarks.
  double outliers = 0.0;
  Sensor sensor = Sensor::kRangeBearing;  ///< kLandmarks only
};

/// A graph as a front-end would have sent it, and what was true. Poses have the ids 0 .. n-1 in
/// order of time, landmarks follow.
struct SimulatedGraph {
  Graph graph;                          ///< values: dead reckoning from the true first pose
  Values truth;                         ///< indexed like graph.values()
  std::vector<FactorRef> outliers;      ///< the false loop closures of `graph`
  std::map<ParameterId, Se2> offsets2;  ///< sensor mountings that factors name, T_body_sensor
  std::map<ParameterId, Se3> offsets3;

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
std::string_view to_string(Sensor sensor);  ///< "range-bearing3", ...
std::optional<Sensor> find_sensor(std::string_view name);
/// All names, in order, for help texts.
std::vector<std::string> world_names();
std::vector<std::string> sensor_names();

}  // namespace cairn
