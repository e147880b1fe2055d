// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/simulate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "cairn/solver/optimize.hpp"
#include "datasets/random.hpp"

namespace cairn {
namespace {

constexpr World kPoseWorlds[] = {World::kManhattan, World::kCity,   World::kSphere,
                                 World::kTorus,     World::kGarage, World::kGrid};

SimulatedGraph simulated(const SimulationOptions& options) {
  auto result = simulate(options);
  EXPECT_TRUE(result) << result.error().to_string();
  return std::move(*result);
}

// FNV-1a over everything a graph says, rounded to 1e-9 so that libm's last bit does not matter.
class Fingerprint {
 public:
  void add(double x) { add_bits(static_cast<std::uint64_t>(std::llround(x * 1e9))); }
  void add_bits(std::uint64_t x) {
    for (int i = 0; i < 8; ++i) hash_ = (hash_ ^ ((x >> (8 * i)) & 0xFF)) * 0x100000001B3ULL;
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xCBF29CE484222325ULL;
};

std::uint64_t fingerprint(const Graph& graph) {
  Fingerprint print;
  for (const Se2& T : graph.values().pose2)
    print.add(T.x()), print.add(T.y()), print.add(std::cos(T.theta()));
  for (const Se3& T : graph.values().pose3) {
    for (int i = 0; i < 3; ++i)
      print.add(T.translation()[i]), print.add(std::abs(T.rotation().quaternion().vec()[i]));
  }
  for (const Eigen::Vector2d& p : graph.values().point2) print.add(p.x()), print.add(p.y());
  for (const Eigen::Vector3d& p : graph.values().point3)
    print.add(p.x()), print.add(p.y()), print.add(p.z());
  for (const FactorRef factor : graph.factors()) {
    for (const VariableSlot slot : graph.slots_of(factor)) print.add_bits(slot);
    const auto evaluation =
        graph.batches()[factor.batch]->evaluate(factor.index, {.values = graph.values()});
    print.add(1e-3 * evaluation.residual.squaredNorm());
  }
  return print.value();
}

std::size_t component_count(const Graph& graph) {
  std::vector<VariableSlot> parent(graph.variables().size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](VariableSlot s) {
    while (parent[s] != s) s = parent[s] = parent[parent[s]];
    return s;
  };
  std::size_t components = parent.size();
  for (const FactorRef factor : graph.factors()) {
    const auto slots = graph.slots_of(factor);
    for (const VariableSlot slot : slots) {
      const auto a = root(slots[0]), b = root(slot);
      if (a != b) parent[a] = b, --components;
    }
  }
  return components;
}

// Normal approximation of the chi2 quantiles; good to a part in a thousand at the sizes used here.
void expect_in_chi2_band(double chi2, double dof) {
  constexpr double kNormal995 = 2.5758;
  EXPECT_GT(chi2, dof - kNormal995 * std::sqrt(2.0 * dof));
  EXPECT_LT(chi2, dof + kNormal995 * std::sqrt(2.0 * dof));
}

std::size_t rows(const Graph& graph) {
  std::size_t rows = 0;
  for (const auto& batch : graph.batches())
    rows += batch->size() * static_cast<std::size_t>(batch->residual_dimension());
  return rows;
}

TEST(Random, NormalNumbersHaveTheMomentsOfTheNormalDistribution) {
  Random random(7);
  constexpr int kCount = 1'000'000;
  double moments[5] = {};
  int beyond_two = 0;
  for (int i = 0; i < kCount; ++i) {
    const double n = random.normal();
    for (int power = 1; power <= 4; ++power) moments[power] += std::pow(n, power) / kCount;
    if (std::abs(n) > 2.0) ++beyond_two;
  }
  EXPECT_NEAR(moments[1], 0.0, 4e-3);  // four standard errors each
  EXPECT_NEAR(moments[2], 1.0, 6e-3);
  EXPECT_NEAR(moments[3], 0.0, 16e-3);
  EXPECT_NEAR(moments[4], 3.0, 4e-2);
  EXPECT_NEAR(beyond_two / static_cast<double>(kCount), 0.0455003, 9e-4);
}

class EveryPoseWorld : public testing::TestWithParam<World> {};
INSTANTIATE_TEST_SUITE_P(Worlds, EveryPoseWorld, testing::ValuesIn(kPoseWorlds),
                         [](const auto& world) { return std::string(to_string(world.param)); });

TEST_P(EveryPoseWorld, TheSameSeedGivesTheSameGraphAndAnotherSeedAnother) {
  const SimulationOptions options{.world = GetParam(), .poses = 400, .seed = 3, .outliers = 0.1};
  SimulationOptions other = options;
  other.seed = 4;
  EXPECT_EQ(fingerprint(simulated(options).graph), fingerprint(simulated(options).graph));
  EXPECT_NE(fingerprint(simulated(options).graph), fingerprint(simulated(other).graph));
}

TEST_P(EveryPoseWorld, Chi2OfTheTrueValuesLiesInItsBandOverManySeeds) {
  double chi2 = 0.0, dof = 0.0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const auto world = simulated({.world = GetParam(), .poses = 200, .seed = seed});
    const Graph truth = world.true_graph();
    chi2 += compute_chi2(truth);
    dof += static_cast<double>(rows(truth));
  }
  expect_in_chi2_band(chi2, dof);
}

TEST_P(EveryPoseWorld, WithoutNoiseTheStartIsTheTruth) {
  const auto world = simulated({.world = GetParam(), .poses = 300, .noise = 0.0});
  EXPECT_LT(compute_chi2(world.true_graph()), 1e-15);
  EXPECT_LT(compute_chi2(world.graph), 1e-9);  // dead reckoning rounds at every step
}

TEST_P(EveryPoseWorld, IsOneComponentWithLoopsAndAsManyPosesAsAskedFor) {
  for (const std::size_t poses : {2, 3, 5, 17, 100, 1001}) {
    const auto world = simulated({.world = GetParam(), .poses = poses});
    EXPECT_EQ(world.graph.variables().size(), poses);
    EXPECT_EQ(world.truth.pose2.size() + world.truth.pose3.size(), poses);
    EXPECT_EQ(component_count(world.graph), 1u) << poses;
    if (poses > 1000) {
      const double edges_per_pose =
          static_cast<double>(world.graph.factor_count()) / static_cast<double>(poses);
      EXPECT_GT(edges_per_pose, 1.4);
      EXPECT_LT(edges_per_pose, 3.5);
    }
  }
}

TEST_P(EveryPoseWorld, ReplacesExactlyTheAskedForFractionOfItsClosures) {
  const SimulationOptions options{.world = GetParam(), .poses = 1000, .outliers = 0.2};
  const auto world = simulated(options);
  const std::size_t loops = world.graph.factor_count() - (options.poses - 1);
  EXPECT_EQ(world.outliers.size(),
            static_cast<std::size_t>(std::llround(0.2 * static_cast<double>(loops))));
  const Graph truth = world.true_graph();
  for (const FactorRef outlier : world.outliers) {
    EXPECT_EQ(truth.batches()[outlier.batch]->kinds()[outlier.index], FactorKind::kLoop);
    double chi2 = 0.0;
    truth.batches()[outlier.batch]->evaluate_chi2(outlier.index, outlier.index + 1,
                                                  {.values = truth.values()}, &chi2);
    EXPECT_GT(chi2, 100.0);  // a false closure is false
  }
}

TEST_P(EveryPoseWorld, MarksKindsAsAFileReaderWould) {
  auto world = simulated({.world = GetParam(), .poses = 500, .outliers = 0.3});
  Graph reread = world.graph;
  for (const FactorRef factor : reread.factors()) reread.set_kind(factor, FactorKind::kOther);
  classify_factor_kinds(reread);
  for (const FactorRef factor : reread.factors()) {
    ASSERT_EQ(reread.batches()[factor.batch]->kinds()[factor.index],
              world.graph.batches()[factor.batch]->kinds()[factor.index]);
  }
}

std::vector<Sensor> every_sensor() {
  std::vector<Sensor> sensors;
  for (const std::string& name : sensor_names()) sensors.push_back(*find_sensor(name));
  return sensors;
}

class EverySensor : public testing::TestWithParam<Sensor> {
 protected:
  static SimulationOptions options(std::uint64_t seed) {
    return {.world = World::kLandmarks, .poses = 150, .seed = seed, .sensor = GetParam()};
  }
};
INSTANTIATE_TEST_SUITE_P(Sensors, EverySensor, testing::ValuesIn(every_sensor()),
                         [](const auto& sensor) {
                           std::string name(to_string(sensor.param));
                           std::erase(name, '-');
                           return name;
                         });

TEST_P(EverySensor, Chi2OfTheTrueValuesLiesInItsBandOverManySeedsBatchByBatch) {
  double chi2[2] = {}, dof[2] = {};
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const Graph truth = simulated(options(seed)).true_graph();
    ASSERT_EQ(truth.batches().size(), 2u);  // odometry and the sensor
    for (std::size_t b = 0; b < 2; ++b) {
      const FactorBatch& batch = *truth.batches()[b];
      chi2[b] += batch.evaluate_cost(0, batch.size(), {.values = truth.values()}).chi2;
      dof[b] += static_cast<double>(batch.size()) * batch.residual_dimension();
    }
  }
  expect_in_chi2_band(chi2[0], dof[0]);
  expect_in_chi2_band(chi2[1], dof[1]);
}

TEST_P(EverySensor, IsOneComponentWhereEveryLandmarkIsSeenOften) {
  for (const std::size_t poses : {2, 20, 300}) {
    SimulationOptions few = options(1);
    few.poses = poses;
    const auto world = simulated(few);
    EXPECT_EQ(component_count(world.graph), 1u);
    std::vector<int> sightings(world.graph.variables().size(), 0);
    for (const FactorRef factor : world.graph.factors()) {
      for (const VariableSlot slot : world.graph.slots_of(factor)) ++sightings[slot];
    }
    for (VariableSlot slot = 0; slot < sightings.size(); ++slot) {
      if (is_pose(world.graph.variables()[slot].type)) continue;
      EXPECT_GE(sightings[slot], 6);
    }
  }
}

TEST_P(EverySensor, WithoutNoiseTheStartIsTheTruth) {
  SimulationOptions exact = options(1);
  exact.noise = 0.0;
  const auto world = simulated(exact);
  EXPECT_LT(compute_chi2(world.true_graph()), 1e-15);
  EXPECT_LT(compute_chi2(world.graph), 1e-9);
}

TEST_P(EverySensor, TheSameSeedGivesTheSameGraphAndAnotherSeedAnother) {
  EXPECT_EQ(fingerprint(simulated(options(3)).graph), fingerprint(simulated(options(3)).graph));
  EXPECT_NE(fingerprint(simulated(options(3)).graph), fingerprint(simulated(options(4)).graph));
}

TEST(Simulate, RefusesOptionsThatMakeNoSense) {
  EXPECT_FALSE(simulate({.poses = 1}));
  EXPECT_FALSE(simulate({.noise = -1.0}));
  EXPECT_FALSE(simulate({.noise = std::nan("")}));
  EXPECT_FALSE(simulate({.outliers = 1.5}));
  EXPECT_FALSE(simulate({.world = World::kLandmarks, .outliers = 0.1}));
}

TEST(Simulate, CityHasAboutTwoEdgesPerPoseAtAnySize) {
  for (const std::size_t poses : {1000, 10000, 100000}) {
    const auto world = simulated({.world = World::kCity, .poses = poses});
    EXPECT_NEAR(static_cast<double>(world.graph.factor_count()) / static_cast<double>(poses), 2.0,
                0.3)
        << poses;
  }
}

}  // namespace
}  // namespace cairn
