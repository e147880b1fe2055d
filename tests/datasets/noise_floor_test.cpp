// SPDX-License-Identifier: BSD-3-Clause
// Consistency of factors, information and solver together: measurements whose noise is drawn from
// their information leave, at the optimum, a chi2 with (rows - unknowns) degrees of freedom, and
// the normalized estimation error e^T H e (e: optimum minus truth), to first order chi2(truth) -
// chi2(optimum), has one degree per unknown.
#include <gtest/gtest.h>

#include <cmath>

#include "cairn/solver/optimize.hpp"
#include "datasets/simulate.hpp"

namespace cairn {
namespace {

constexpr int kSeeds = 50;

// 99 % band of chi2, as a normal distribution: exact to a part in a thousand for the thousands of
// degrees here.
void expect_in_band(double chi2, double dof, const char* what) {
  EXPECT_LT(std::abs(chi2 - dof) / std::sqrt(2.0 * dof), 2.5758)
      << what << ": chi2 " << chi2 << ", degrees " << dof;
}

void expect_noise_floor(SimulationOptions options) {
  double residual = 0.0, residual_dof = 0.0, error = 0.0, error_dof = 0.0;
  for (options.seed = 1; options.seed <= kSeeds; ++options.seed) {
    const auto world = simulate(options);
    ASSERT_TRUE(world);
    Graph graph = world->graph;
    const SolveSummary summary = optimize(graph);
    ASSERT_EQ(summary.status, SolveStatus::kConverged) << "seed " << options.seed;
    double rows = 0.0;
    for (const auto& batch : graph.batches())
      rows += static_cast<double>(batch->size()) * batch->residual_dimension();
    const auto dof = static_cast<double>(summary.degrees_of_freedom);
    residual += summary.final_chi2;
    residual_dof += dof;
    error += compute_chi2(world->true_graph()) - summary.final_chi2;
    error_dof += rows - dof;
  }
  expect_in_band(residual, residual_dof, "residuals");
  expect_in_band(error, error_dof, "estimation error");
}

class NoiseFloorOfSensor : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Sensors, NoiseFloorOfSensor, testing::ValuesIn(sensor_names()),
                         [](const auto& sensor) {
                           std::string name = sensor.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST_P(NoiseFloorOfSensor, IsReachedOverFiftySeeds) {
  expect_noise_floor(
      {.world = World::kLandmarks, .poses = 150, .sensor = *find_sensor(GetParam())});
}

class NoiseFloorOfWorld : public testing::TestWithParam<World> {};
INSTANTIATE_TEST_SUITE_P(Worlds, NoiseFloorOfWorld,
                         testing::Values(World::kManhattan, World::kCity, World::kSphere,
                                         World::kTorus, World::kGarage, World::kGrid),
                         [](const auto& world) { return std::string(to_string(world.param)); });

TEST_P(NoiseFloorOfWorld, IsReachedOverFiftySeeds) {
  expect_noise_floor({.world = GetParam(), .poses = 250});
}

}  // namespace
}  // namespace cairn
