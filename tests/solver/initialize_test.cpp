// SPDX-License-Identifier: BSD-3-Clause
// Measurements without noise determine the map, so every initialization that uses them must start
// there, up to rounding.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "cairn/factors/prior.hpp"
#include "cairn/solver/optimize.hpp"
#include "datasets/simulate.hpp"
#include "tests/solver/small_problems.hpp"

namespace cairn {
namespace {

using test::bits;
using test::circle;
using test::Plane;
using test::RandomNumbers;
using test::Space;
using testing::ElementsAre;

// chi2 of rounding alone: coordinates of some 10 m, information of some 1e4.
constexpr double kRounding = 1e-20;

// The start that optimize() would iterate from.
SolveSummary start_only(Graph& graph, InitMethod init) {
  return optimize(graph, {.init = init, .max_iterations = 0});
}

std::vector<InitMethod> methods_of(const SolveSummary& summary) {
  std::vector<InitMethod> methods;
  for (const InitCandidate& candidate : summary.init_candidates)
    methods.push_back(candidate.method);
  return methods;
}

// m or rad.
double worst_difference(const Values& a, const Values& b) {
  double worst = 0.0;
  const auto note = [&](const auto& difference) { worst = std::max(worst, difference.norm()); };
  for (std::size_t i = 0; i < a.pose2.size(); ++i) note((a.pose2[i].inverse() * b.pose2[i]).log());
  for (std::size_t i = 0; i < a.pose3.size(); ++i) note((a.pose3[i].inverse() * b.pose3[i]).log());
  for (std::size_t i = 0; i < a.point2.size(); ++i) note(a.point2[i] - b.point2[i]);
  for (std::size_t i = 0; i < a.point3.size(); ++i) note(a.point3[i] - b.point3[i]);
  return worst;
}

template <class World>
class InitializeTest : public testing::Test {};
struct WorldNames {
  template <class World>
  static std::string GetName(int) {
    return std::is_same_v<World, Plane> ? "Plane" : "Space";
  }
};
using Worlds = testing::Types<Plane, Space>;
TYPED_TEST_SUITE(InitializeTest, Worlds, WorldNames);

constexpr InitMethod kMeasured[] = {InitMethod::kOdometry, InitMethod::kTree, InitMethod::kChordal};

TYPED_TEST(InitializeTest, StartsNoiseFreePosesExactly) {
  const Graph truth = circle<TypeParam>(40, 12, 0, 0.0, 0.0, 1);
  for (const InitMethod init : kMeasured) {
    Graph graph = circle<TypeParam>(40, 12, 0, 0.0, 0.8, 1);
    const SolveSummary summary = start_only(graph, init);
    EXPECT_LT(summary.initial_chi2, kRounding) << to_string(init);
    EXPECT_LT(worst_difference(graph.values(), truth.values()), 1e-11) << to_string(init);
    EXPECT_EQ(summary.init_chosen, init);
    EXPECT_THAT(methods_of(summary), ElementsAre(init));
  }
}

TYPED_TEST(InitializeTest, StartsNoiseFreeLandmarksExactly) {
  const Graph truth = circle<TypeParam>(30, 8, 12, 0.0, 0.0, 2);
  for (const InitMethod init : kMeasured) {
    Graph graph = circle<TypeParam>(30, 8, 12, 0.0, 0.8, 2);
    EXPECT_LT(start_only(graph, init).initial_chi2, kRounding) << to_string(init);
    EXPECT_LT(worst_difference(graph.values(), truth.values()), 1e-11) << to_string(init);
  }
}

TYPED_TEST(InitializeTest, StartsFromHeldVariablesAndLeavesThemBitForBit) {
  const Graph truth = circle<TypeParam>(30, 8, 12, 0.0, 0.0, 3);
  for (const InitMethod init : kMeasured) {
    Graph graph = circle<TypeParam>(30, 8, 12, 0.0, 0.8, 3);
    graph.values() = truth.values();
    RandomNumbers random(4);
    for (std::size_t i = 0; i < 30; ++i) {
      auto& T = TypeParam::poses(graph.values())[i];
      if (i != 11 && i != 24) T = T.retract(random.vector<TypeParam::kPose>(0.8));
    }
    for (std::size_t l = 1; l < 12; ++l)
      TypeParam::points(graph.values())[l] += random.vector<TypeParam::kPoint>(0.8);
    for (const VariableSlot slot : {11u, 24u, 30u}) graph.set_fixed(slot, true);
    const SolveSummary summary = start_only(graph, init);
    EXPECT_TRUE(summary.gauge.empty());
    EXPECT_LT(summary.initial_chi2, kRounding) << to_string(init);
    EXPECT_LT(worst_difference(graph.values(), truth.values()), 1e-11) << to_string(init);
    const auto [before, after] = std::pair(bits(truth.values()), bits(graph.values()));
    const std::size_t pose = before.size() > 30 * 7 ? 7 : 3;  // numbers in `bits`
    for (const std::size_t held : {11u, 24u}) {
      EXPECT_TRUE(std::equal(before.begin() + static_cast<long>(held * pose),
                             before.begin() + static_cast<long>((held + 1) * pose),
                             after.begin() + static_cast<long>(held * pose)))
          << to_string(init) << ", pose " << held;
    }
    EXPECT_EQ(TypeParam::points(truth.values())[0], TypeParam::points(graph.values())[0]);
  }
}

// Nothing is held where an absolute factor ties the map: the start keeps the smallest id instead.
TYPED_TEST(InitializeTest, StartsExactlyWhereAPriorTiesTheMap) {
  const Graph truth = circle<TypeParam>(30, 8, 12, 0.0, 0.0, 10);
  for (const InitMethod init : kMeasured) {
    Graph graph = circle<TypeParam>(30, 8, 12, 0.0, 0.8, 10);
    const auto& T_map_body = TypeParam::poses(truth.values())[0];
    if constexpr (std::is_same_v<TypeParam, Plane>) {
      const PriorSe2 prior{T_map_body, Eigen::Matrix3d::Identity()};
      ASSERT_TRUE(graph.add_factor(prior, {VariableId{0}}));
    } else {
      const PriorSe3 prior{T_map_body, {}, Matrix6d::Identity()};
      ASSERT_TRUE(graph.add_factor(prior, {VariableId{0}}));
    }
    const SolveSummary summary = start_only(graph, init);
    EXPECT_TRUE(summary.gauge.empty());
    EXPECT_EQ(summary.init_chosen, init);
    EXPECT_LT(summary.initial_chi2, kRounding) << to_string(init);
    EXPECT_LT(worst_difference(graph.values(), truth.values()), 1e-11) << to_string(init);
  }
}

TYPED_TEST(InitializeTest, AutoStopsAtTheFirstStartThatExplainsTheMeasurements) {
  Graph good = circle<TypeParam>(40, 12, 0, 0.0, 0.0, 5);
  const SolveSummary kept = start_only(good, InitMethod::kAuto);
  EXPECT_EQ(kept.init_chosen, InitMethod::kFile);
  EXPECT_THAT(methods_of(kept), ElementsAre(InitMethod::kFile));

  Graph bad = circle<TypeParam>(40, 12, 0, 0.0, 0.8, 5);
  const SolveSummary replaced = start_only(bad, InitMethod::kAuto);
  EXPECT_EQ(replaced.init_chosen, InitMethod::kOdometry);
  EXPECT_THAT(methods_of(replaced), ElementsAre(InitMethod::kFile, InitMethod::kOdometry));
  EXPECT_LT(replaced.initial_chi2, kRounding);
}

TYPED_TEST(InitializeTest, AutoTakesTheCheapestWhereNoneExplainsTheMeasurements) {
  // Edges that contradict each other far beyond their information.
  Graph graph = circle<TypeParam>(40, 12, 0, 3.0, 0.8, 6);
  const SolveSummary summary = start_only(graph, InitMethod::kAuto);
  EXPECT_THAT(methods_of(summary), ElementsAre(InitMethod::kFile, InitMethod::kOdometry,
                                               InitMethod::kTree, InitMethod::kChordal));
  const auto cheapest =
      std::min_element(summary.init_candidates.begin(), summary.init_candidates.end(),
                       [](const auto& a, const auto& b) { return a.chi2 < b.chi2; });
  EXPECT_EQ(summary.init_chosen, cheapest->method);
  EXPECT_NEAR(summary.initial_chi2, cheapest->chi2, 1e-12 * cheapest->chi2);
}

TYPED_TEST(InitializeTest, StartsEachComponentFromItsSmallestId) {
  Graph graph = circle<TypeParam>(20, 4, 0, 0.0, 0.0, 7);
  const Graph truth = graph;
  RandomNumbers random(8);
  // A second drive, measured as the first, from another place.
  const auto T_map_other = TypeParam::Pose::exp(random.vector<TypeParam::kPose>(2.0));
  const auto& first = TypeParam::poses(truth.values());
  for (std::size_t i = 0; i < 20; ++i) {
    ASSERT_TRUE(TypeParam::add_pose(graph, 100 + i,
                                    i == 0 ? T_map_other * first[0] : typename TypeParam::Pose()));
  }
  const auto* edges = truth.find_batch<typename TypeParam::Between>();
  for (std::size_t e = 0; e < edges->size(); ++e) {
    const auto ends = edges->variable_indices().subspan(2 * e, 2);
    ASSERT_TRUE(graph.add_factor(edges->factor(e),
                                 {VariableId{100 + ends[0]}, VariableId{100 + ends[1]}},
                                 edges->kinds()[e]));
  }
  for (const InitMethod init : kMeasured) {
    Graph started = graph;
    EXPECT_LT(start_only(started, init).initial_chi2, kRounding) << to_string(init);
    for (std::size_t i = 0; i < 20; ++i) {
      const auto& T_map_i = TypeParam::poses(started.values())[20 + i];
      EXPECT_LT((T_map_i.translation() - (T_map_other * first[i]).translation()).norm(), 1e-12)
          << to_string(init) << ", pose " << 100 + i;
    }
  }
}

// Sensors whose single sighting does not place a landmark leave it where the file has it.
bool places_landmarks(Sensor sensor) {
  return sensor != Sensor::kBearing && sensor != Sensor::kRange && sensor != Sensor::kRange3;
}

class InitializeWithSensor : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Sensors, InitializeWithSensor, testing::ValuesIn(sensor_names()),
                         [](const auto& sensor) {
                           std::string name = sensor.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST_P(InitializeWithSensor, StartsNoiseFreeGraphsExactly) {
  const Sensor sensor = *find_sensor(GetParam());
  const auto world =
      simulate({.world = World::kLandmarks, .poses = 90, .noise = 0.0, .sensor = sensor});
  ASSERT_TRUE(world);
  for (const InitMethod init : kMeasured) {
    Graph graph = world->graph;
    RandomNumbers random(9);
    Values& values = graph.values();
    for (std::size_t i = 1; i < values.pose2.size(); ++i)
      values.pose2[i] = values.pose2[i].retract(random.vector<3>(0.5));
    for (std::size_t i = 1; i < values.pose3.size(); ++i)
      values.pose3[i] = values.pose3[i].retract(random.vector<6>(0.5));
    if (places_landmarks(sensor)) {
      for (auto& p : values.point2) p += random.vector<2>(3.0);
      for (auto& p : values.point3) p += random.vector<3>(3.0);
    }
    const SolveSummary summary = start_only(graph, init);
    EXPECT_LT(summary.initial_chi2, 1e-15) << to_string(init);
    EXPECT_LT(worst_difference(graph.values(), world->truth), 1e-9) << to_string(init);
  }
}

}  // namespace
}  // namespace cairn
