// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/simulate.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "datasets/recorder.hpp"

namespace cairn {
namespace {

struct WorldTraits {
  World world;
  std::string_view name;
  std::size_t default_poses;
  WalkSigmas sigmas;
};
constexpr std::array kWorlds{
    WorldTraits{
        World::kManhattan, "manhattan", 3500, {{.03, .02, 0, .01, 0}, {.05, .03, 0, .01, 0}}},
    WorldTraits{World::kCity, "city", 10000, {{.02, .01, 0, .003, 0}, {.05, .03, 0, .005, 0}}},
    WorldTraits{
        World::kSphere, "sphere", 2500, {{.1, .08, .06, .02, .015}, {.12, .08, .08, .02, .015}}},
    WorldTraits{
        World::kTorus, "torus", 5000, {{.05, .04, .03, .01, .008}, {.06, .04, .04, .01, .008}}},
    WorldTraits{
        World::kGarage, "garage", 1600, {{.03, .02, .01, .004, .001}, {.1, .05, .03, .01, .003}}},
    WorldTraits{World::kGrid, "grid", 2000, {{.02, .02, .02, .01, .01}, {.03, .02, .02, .01, .01}}},
    WorldTraits{World::kLandmarks,
                "landmarks",
                600,
                {{.02, .01, .01, .003, .002}, {.05, .03, .03, .005, .005}}},
};
constexpr std::array<std::string_view, 18> kSensorNames{
    "xy",    "bearing",  "range",  "range-bearing", "gnss",   "yaw",
    "prior", "position", "offset", "xyz",           "range3", "range-bearing3",
    "gnss3", "altitude", "yaw3",   "gravity",       "prior3", "offset3"};

const WorldTraits& traits(World world) {
  return *std::find_if(kWorlds.begin(), kWorlds.end(),
                       [&](const WorldTraits& w) { return w.world == world; });
}

SimulatedGraph record(const SimulationOptions& options) {
  Random random(options.seed, kWorldStream);
  const std::size_t poses = options.poses;
  const WalkSigmas sigmas = traits(options.world).sigmas.scaled(options.noise);
  const auto record = [&](auto walk) {
    return Recorder(std::move(walk), sigmas, options).record();
  };
  switch (options.world) {
    case World::kManhattan:
      return record(walk_manhattan(poses, random));
    case World::kCity:
      return record(walk_city(poses, random));
    case World::kSphere:
      return record(walk_sphere(poses));
    case World::kTorus:
      return record(walk_torus(poses));
    case World::kGarage:
      return record(walk_garage(poses));
    case World::kGrid:
      return record(walk_grid(poses, random));
    case World::kLandmarks:
      return simulate_landmarks(sigmas, options, random);
  }
  CAIRN_CHECK(false, "unknown world");
}

Error bad_option(std::string message) { return {ErrorCode::kUsage, std::move(message)}; }

}  // namespace

Graph SimulatedGraph::true_graph() const {
  Graph copy = graph;
  copy.values() = truth;
  return copy;
}

Result<SimulatedGraph> simulate(const SimulationOptions& options) {
  SimulationOptions complete = options;
  if (complete.poses == 0) complete.poses = default_poses(options.world);
  if (complete.poses < 2) return bad_option("a simulated graph needs at least 2 poses");
  if (complete.poses > 1'000'000'000)
    return bad_option("at most 1000000000 poses can be simulated");
  if (!(options.noise >= 0.0 && options.noise <= 10.0)) {
    return bad_option(
        "the noise factor must lie between 0 (exact) and 10; 1 is the world's own noise");
  }
  if (!(options.outliers >= 0.0 && options.outliers <= 1.0)) {
    return bad_option("the outlier fraction must lie between 0 and 1");
  }
  if (options.world == World::kLandmarks && options.outliers > 0.0) {
    return bad_option(
        "the landmarks world has no loop closures that could be false; leave the outlier fraction "
        "at 0");
  }
  return record(complete);
}

std::size_t default_poses(World world) { return traits(world).default_poses; }

std::string_view to_string(Sensor sensor) { return kSensorNames[static_cast<std::size_t>(sensor)]; }

std::optional<Sensor> find_sensor(std::string_view name) {
  const auto found = std::find(kSensorNames.begin(), kSensorNames.end(), name);
  if (found == kSensorNames.end()) return std::nullopt;
  return static_cast<Sensor>(found - kSensorNames.begin());
}

std::vector<std::string> sensor_names() { return {kSensorNames.begin(), kSensorNames.end()}; }

std::vector<std::string> world_names() {
  std::vector<std::string> names;
  for (const WorldTraits& world : kWorlds) names.emplace_back(world.name);
  return names;
}

std::string_view to_string(World world) { return traits(world).name; }

std::optional<World> find_world(std::string_view name) {
  for (const WorldTraits& world : kWorlds) {
    if (world.name == name) return world.world;
  }
  return std::nullopt;
}

}  // namespace cairn
