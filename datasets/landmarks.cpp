// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "datasets/recorder.hpp"
#include "datasets/sensor_models.hpp"

namespace cairn {
namespace {

constexpr double kLaps = 3.0;
constexpr double kLandmarkSpacingM = 2.0;  // along the course
constexpr double kMinRangeM = 1.0, kMaxRangeM = 12.0;
constexpr int kMinSightings =
    6;  // landmarks seen less often are left out: they would hang on few measurements
constexpr std::uint32_t kNoNumber = ~std::uint32_t{0};

template <class Pose>
using PointOf = std::conditional_t<std::is_same_v<Pose, Se2>, Eigen::Vector2d, Eigen::Vector3d>;

// Landmarks beside the course, and which of them each pose sees.
template <class Pose>
struct Landscape {
  std::vector<PointOf<Pose>> landmarks;
  std::vector<std::vector<std::uint32_t>> seen_from;
};

template <class Pose>
std::vector<PointOf<Pose>> scatter(const Course& course, Random& random) {
  std::vector<PointOf<Pose>> landmarks(static_cast<std::size_t>(course.lap_m / kLandmarkSpacingM));
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const double station = kLandmarkSpacingM * (static_cast<double>(i) + random.uniform());
    const Eigen::Vector3d ahead = course.ahead(station);
    const Eigen::Vector3d left = Eigen::Vector3d(-ahead.y(), ahead.x(), 0.0).normalized();
    const double side_m = (random.chance(0.5) ? 1.0 : -1.0) * random.uniform(2.0, 7.0);
    const Eigen::Vector3d up = random.uniform(-4.0, 4.0) * Eigen::Vector3d::UnitZ();
    landmarks[i] = (course.position(station) + side_m * left + up)
                       .template head<PointOf<Pose>::RowsAtCompileTime>();
  }
  return landmarks;
}

template <class Pose>
Landscape<Pose> look_around(const Course& course, const std::vector<Pose>& poses, Random& random) {
  const auto candidates = scatter<Pose>(course, random);
  const auto count = static_cast<std::int64_t>(candidates.size());
  Landscape<Pose> scene{{}, std::vector<std::vector<std::uint32_t>>(poses.size())};
  std::vector<int> sightings(candidates.size(), 0);
  for (std::size_t i = 0; i < poses.size() && count > 0; ++i) {
    const double station = std::fmod(static_cast<double>(i), course.lap_m);
    const auto here = static_cast<std::int64_t>(station / kLandmarkSpacingM);
    const std::int64_t reach = std::min<std::int64_t>(6, (count - 1) / 2);
    for (std::int64_t k = here - reach; k <= here + reach; ++k) {
      const auto landmark = static_cast<std::uint32_t>((k + count) % count);
      const double range_m = (candidates[landmark] - poses[i].translation()).norm();
      if (range_m < kMinRangeM || range_m > kMaxRangeM) continue;
      scene.seen_from[i].push_back(landmark);
      ++sightings[landmark];
    }
  }
  for (auto& seen : scene.seen_from)
    std::erase_if(seen, [&](std::uint32_t l) { return sightings[l] < kMinSightings; });
  scene.landmarks = candidates;
  return scene;
}

// Records a walk together with one sensor.
template <class Pose>
class LandmarkWorld {
 public:
  LandmarkWorld(const Course& course, Walk<Pose> walk, const WalkSigmas& sigmas,
                const SimulationOptions& options, Random& random)
      : course_(course),
        walk_(std::move(walk)),
        sigmas_(sigmas),
        options_(options),
        random_(random),
        sensors_(options.noise, random) {}

  /// `measure(T_map_body, p_map)` for each sighting of a landmark.
  template <class Measure>
  SimulatedGraph with_landmarks(Measure&& measure) {
    const Landscape<Pose> scene = look_around(course_, walk_.poses, random_);
    std::vector<std::uint32_t> number(scene.landmarks.size(), kNoNumber);
    std::uint32_t numbered = 0;
    return record([&](std::uint32_t i, SimulatedGraph& out) {
      for (const std::uint32_t landmark : scene.seen_from[i]) {
        const auto& p_map = scene.landmarks[landmark];
        if (number[landmark] == kNoNumber) {
          number[landmark] = numbered++;
          add_point(out, landmark_id(number[landmark]), p_map, guess(i, p_map, out.graph.values()));
        }
        add(out, measure(walk_.poses[i], p_map),
            std::array{VariableId{i}, landmark_id(number[landmark])});
      }
    });
  }

  /// `measure(T_map_body)` at every `every`-th pose. `hold_first`: the sensor does not tell
  /// everything about the map frame, so the first pose is fixed.
  template <class Measure>
  SimulatedGraph with_fixes(std::uint32_t every, bool hold_first, Measure&& measure) {
    return record([&](std::uint32_t i, SimulatedGraph& out) {
      if (i == 0) out.graph.set_fixed(0, hold_first);
      if (i % every == 0) add(out, measure(walk_.poses[i]), std::array{VariableId{i}});
    });
  }

  /// `measure(T_map_a, T_map_b)` between each pose and the one a lap before.
  template <class Measure>
  SimulatedGraph with_closures(Measure&& measure) {
    const auto lap = static_cast<std::uint32_t>(std::lround(course_.lap_m));
    return record([&](std::uint32_t i, SimulatedGraph& out) {
      if (i < lap) return;
      const auto factor = measure(walk_.poses[i - lap], walk_.poses[i]);
      add(out, factor, std::array{VariableId{i - lap}, VariableId{i}}, FactorKind::kLoop);
    });
  }

  SensorModels& sensors() { return sensors_; }

 private:
  SimulatedGraph record(const typename Recorder<Pose>::Observe& observe) {
    return Recorder<Pose>(walk_, sigmas_, options_).record(observe);
  }

  [[nodiscard]] VariableId landmark_id(std::uint32_t number) const {
    return {walk_.poses.size() + number};
  }

  // Where a robot that trusts its dead reckoning would put the landmark: off by a tenth of its
  // distance.
  PointOf<Pose> guess(std::uint32_t i, const PointOf<Pose>& p_map, const Values& values) {
    PointOf<Pose> p_body = walk_.poses[i].inverse() * p_map;
    const double sigma_m = options_.noise > 0.0 ? 0.1 * p_body.norm() : 0.0;
    for (double& coordinate : p_body) coordinate += sigma_m * random_.normal();
    if constexpr (std::is_same_v<Pose, Se2>) {
      return values.pose2[i] * p_body;
    } else {
      return values.pose3[i] * p_body;
    }
  }

  static void add_point(SimulatedGraph& out, VariableId id, const Eigen::Vector2d& truth,
                        const Eigen::Vector2d& start) {
    CAIRN_CHECK(out.graph.add_point2(id, start), "a simulated landmark was refused");
    out.truth.point2.push_back(truth);
  }
  static void add_point(SimulatedGraph& out, VariableId id, const Eigen::Vector3d& truth,
                        const Eigen::Vector3d& start) {
    CAIRN_CHECK(out.graph.add_point3(id, start), "a simulated landmark was refused");
    out.truth.point3.push_back(truth);
  }
  template <class F, std::size_t kArity>
  static void add(SimulatedGraph& out, const F& factor, const std::array<VariableId, kArity>& ids,
                  FactorKind kind = FactorKind::kOther) {
    CAIRN_CHECK(out.graph.add_factor(factor, ids, kind), "a simulated factor was refused");
  }

  Course course_;
  Walk<Pose> walk_;
  WalkSigmas sigmas_;
  SimulationOptions options_;
  Random& random_;
  SensorModels sensors_;
};

SimulatedGraph simulate_plane(LandmarkWorld<Se2> world, Sensor sensor) {
  using P = Eigen::Vector2d;
  SensorModels& see = world.sensors();
  switch (sensor) {
    case Sensor::kXy:
      return world.with_landmarks([&](const Se2& T, const P& p) { return see.landmark_xy(T, p); });
    case Sensor::kBearing:
      return world.with_landmarks([&](const Se2& T, const P& p) { return see.bearing(T, p); });
    case Sensor::kRange:
      return world.with_landmarks([&](const Se2& T, const P& p) { return see.range(T, p); });
    case Sensor::kRangeBearing:
      return world.with_landmarks(
          [&](const Se2& T, const P& p) { return see.range_bearing(T, p); });
    case Sensor::kGnss:
      return world.with_fixes(5, false, [&](const Se2& T) { return see.gnss(T); });
    case Sensor::kYaw:
      return world.with_fixes(2, true, [&](const Se2& T) { return see.yaw(T); });
    case Sensor::kPrior:
      return world.with_fixes(10, false, [&](const Se2& T) { return see.prior(T); });
    case Sensor::kPosition:
      return world.with_fixes(5, false, [&](const Se2& T) { return see.position(T); });
    case Sensor::kOffset:
      return world.with_closures(
          [&](const Se2& a, const Se2& b) { return see.between_offset(a, b); });
    default:
      CAIRN_CHECK(false, "not a sensor of the plane");
  }
}

SimulatedGraph simulate_space(LandmarkWorld<Se3> world, Sensor sensor) {
  using P = Eigen::Vector3d;
  SensorModels& see = world.sensors();
  switch (sensor) {
    case Sensor::kXyz:
      return world.with_landmarks([&](const Se3& T, const P& p) { return see.landmark_xyz(T, p); });
    case Sensor::kRange3:
      return world.with_landmarks([&](const Se3& T, const P& p) { return see.range(T, p); });
    case Sensor::kRangeBearing3:
      return world.with_landmarks(
          [&](const Se3& T, const P& p) { return see.range_bearing(T, p); });
    case Sensor::kGnss3:
      return world.with_fixes(5, false, [&](const Se3& T) { return see.gnss(T); });
    case Sensor::kAltitude:
      return world.with_fixes(2, true, [&](const Se3& T) { return see.altitude(T); });
    case Sensor::kYaw3:
      return world.with_fixes(2, true, [&](const Se3& T) { return see.yaw(T); });
    case Sensor::kGravity:
      return world.with_fixes(2, true, [&](const Se3& T) { return see.gravity(T); });
    case Sensor::kPrior3:
      return world.with_fixes(10, false, [&](const Se3& T) { return see.prior(T); });
    case Sensor::kOffset3:
      return world.with_closures(
          [&](const Se3& a, const Se3& b) { return see.between_offset(a, b); });
    default:
      CAIRN_CHECK(false, "not a sensor of space");
  }
}

}  // namespace

SimulatedGraph simulate_landmarks(const WalkSigmas& sigmas, const SimulationOptions& options,
                                  Random& random) {
  const Course course{std::max(12.0, std::round(static_cast<double>(options.poses) / kLaps))};
  const Sensor sensor = options.sensor;
  if (sensor < Sensor::kXyz) {
    LandmarkWorld<Se2> world(course, course.walk2(options.poses), sigmas, options, random);
    SimulatedGraph out = simulate_plane(std::move(world), sensor);
    if (sensor == Sensor::kXy || sensor == Sensor::kOffset) {
      out.offsets2.emplace(SensorModels::kMounting2, SensorModels::mounting2());
    }
    return out;
  }
  LandmarkWorld<Se3> world(course, course.walk3(options.poses), sigmas, options, random);
  SimulatedGraph out = simulate_space(std::move(world), sensor);
  if (sensor == Sensor::kXyz || sensor == Sensor::kOffset3 || sensor == Sensor::kPrior3) {
    out.offsets3.emplace(SensorModels::kMounting3, SensorModels::mounting3());
  }
  return out;
}

}  // namespace cairn
