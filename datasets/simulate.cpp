// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/simulate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "datasets/noise.hpp"
#include "datasets/walk.hpp"

namespace cairn {
namespace {

enum Stream : std::uint64_t { kWorldStream, kNoiseStream, kOutlierStream };

struct WorldTraits {
  World world;
  std::string_view name;
  std::size_t default_poses;
  PoseSigmas odometry, closure;
};
constexpr std::array kWorlds{
    WorldTraits{World::kManhattan, "manhattan", 3500, {.03, .02, 0, .01, 0}, {.05, .03, 0, .01, 0}},
    WorldTraits{World::kCity, "city", 10000, {.02, .01, 0, .003, 0}, {.05, .03, 0, .005, 0}},
    WorldTraits{
        World::kSphere, "sphere", 2500, {.1, .08, .06, .02, .015}, {.12, .08, .08, .02, .015}},
    WorldTraits{
        World::kTorus, "torus", 5000, {.05, .04, .03, .01, .008}, {.06, .04, .04, .01, .008}},
    WorldTraits{
        World::kGarage, "garage", 1600, {.03, .02, .01, .004, .001}, {.1, .05, .03, .01, .003}},
    WorldTraits{World::kGrid, "grid", 2000, {.02, .02, .02, .01, .01}, {.03, .02, .02, .01, .01}},
};

const WorldTraits& traits(World world) {
  return *std::find_if(kWorlds.begin(), kWorlds.end(),
                       [&](const WorldTraits& w) { return w.world == world; });
}

PoseSigmas scaled(const PoseSigmas& s, double noise) {
  const double f = noise > 0.0 ? noise : 1.0;
  return {f * s.ahead_m, f * s.sideways_m, f * s.vertical_m, f * s.yaw_rad, f * s.tilt_rad};
}

void add_pose(Graph& graph, VariableId id, const Se2& T_map_body) {
  CAIRN_CHECK(graph.add_pose2(id, T_map_body), "a simulated pose was refused");
}
void add_pose(Graph& graph, VariableId id, const Se3& T_map_body) {
  CAIRN_CHECK(graph.add_pose3(id, T_map_body), "a simulated pose was refused");
}

// Exactly `count` of `total`, each choice equally likely, in order (Knuth, TAOCP 2, 3.4.2,
// algorithm S).
std::vector<bool> choose(std::size_t count, std::size_t total, Random& random) {
  std::vector<bool> chosen(total, false);
  for (std::size_t i = 0; i < total && count > 0; ++i) {
    if (random.index(total - i) < count) chosen[i] = true, --count;
  }
  return chosen;
}

// The earlier pose that a false closure takes for loop.from: far from both in time where there is
// such a pose.
std::uint32_t mistaken_pose(const LoopPair& loop, Random& random) {
  const std::uint32_t gap = std::min<std::uint32_t>(loop.to / 5, 50);
  const auto distance = [](std::uint32_t a, std::uint32_t b) { return a < b ? b - a : a - b; };
  for (int attempt = 0;; ++attempt) {
    const auto other = static_cast<std::uint32_t>(random.index(loop.to - 1));
    const std::uint32_t wanted = attempt < 100 ? gap : 1;
    if (distance(other, loop.from) >= wanted && loop.to - other >= wanted) return other;
  }
}

// Turns what the robot did into what it measured.
template <class Pose>
class Recorder {
 public:
  Recorder(Walk<Pose> walk, const SimulationOptions& options)
      : walk_(std::move(walk)),
        exact_(options.noise == 0.0),
        odometry_(scaled(traits(options.world).odometry, options.noise)),
        closure_(scaled(traits(options.world).closure, options.noise)),
        noise_(options.seed, kNoiseStream),
        mistakes_(options.seed, kOutlierStream) {
    const auto loops = static_cast<double>(walk_.loops.size());
    is_false_ = choose(static_cast<std::size_t>(std::llround(options.outliers * loops)),
                       walk_.loops.size(), mistakes_);
  }

  SimulatedGraph record() {
    out_.graph.reserve(walk_.poses.size());
    std::size_t loop = 0;
    for (std::uint32_t i = 0; i < walk_.poses.size(); ++i) {
      add_next_pose(i);
      for (; loop < walk_.loops.size() && walk_.loops[loop].to == i; ++loop) add_loop(loop);
    }
    if constexpr (std::is_same_v<Pose, Se2>) {
      out_.truth.pose2 = std::move(walk_.poses);
    } else {
      out_.truth.pose3 = std::move(walk_.poses);
    }
    return std::move(out_);
  }

 private:
  [[nodiscard]] Pose relative(std::uint32_t a, std::uint32_t b) const {
    return walk_.poses[a].inverse() * walk_.poses[b];
  }

  void add_next_pose(std::uint32_t i) {
    if (i == 0) {
      reckoned_ = walk_.poses[0];
      add_pose(out_.graph, {0}, reckoned_);
      return;
    }
    const Pose T_a_b = relative(i - 1, i);
    const auto odometry =
        draw_between(T_a_b, pose_information(odometry_, T_a_b, 0.0), exact_, noise_);
    reckoned_ = (reckoned_ * odometry.T_a_b_measured).retract(Pose::Tangent::Zero());
    add_pose(out_.graph, {i}, reckoned_);
    add_between(odometry, i - 1, i, FactorKind::kOdometry);
  }

  void add_loop(std::size_t index) {
    const LoopPair& loop = walk_.loops[index];
    const Pose T_a_b = relative(loop.from, loop.to);
    const double axis_rad = noise_.uniform(0.0, std::numbers::pi);
    const auto closure =
        draw_between(T_a_b, pose_information(closure_, T_a_b, axis_rad), exact_, noise_);
    if (is_false_[index]) {
      out_.outliers.push_back(
          add_between(closure, mistaken_pose(loop, mistakes_), loop.to, FactorKind::kLoop));
    } else {
      add_between(closure, loop.from, loop.to, FactorKind::kLoop);
    }
  }

  template <class Between>
  FactorRef add_between(const Between& factor, std::uint32_t from, std::uint32_t to,
                        FactorKind kind) {
    const auto added = out_.graph.add_factor(factor, {VariableId{from}, VariableId{to}}, kind);
    CAIRN_CHECK(added, "a simulated factor was refused");
    return *added;
  }

  Walk<Pose> walk_;
  bool exact_;
  PoseSigmas odometry_, closure_;
  Random noise_, mistakes_;
  std::vector<bool> is_false_;
  Pose reckoned_;
  SimulatedGraph out_;
};

SimulatedGraph record(const SimulationOptions& options) {
  Random random(options.seed, kWorldStream);
  const std::size_t poses = options.poses;
  switch (options.world) {
    case World::kManhattan:
      return Recorder(walk_manhattan(poses, random), options).record();
    case World::kCity:
      return Recorder(walk_city(poses, random), options).record();
    case World::kSphere:
      return Recorder(walk_sphere(poses), options).record();
    case World::kTorus:
      return Recorder(walk_torus(poses), options).record();
    case World::kGarage:
      return Recorder(walk_garage(poses), options).record();
    case World::kGrid:
      return Recorder(walk_grid(poses, random), options).record();
    case World::kLandmarks:
      break;
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
  if (!(options.noise >= 0.0 && options.noise <= 100.0)) {
    return bad_option(
        "the noise factor must lie between 0 (exact) and 100; 1 is the world's own noise");
  }
  if (!(options.outliers >= 0.0 && options.outliers <= 1.0)) {
    return bad_option("the outlier fraction must lie between 0 and 1");
  }
  return record(complete);
}

std::size_t default_poses(World world) { return traits(world).default_poses; }

std::string_view to_string(World world) { return traits(world).name; }

std::optional<World> find_world(std::string_view name) {
  for (const WorldTraits& world : kWorlds) {
    if (world.name == name) return world.world;
  }
  return std::nullopt;
}

}  // namespace cairn
