// SPDX-License-Identifier: BSD-3-Clause
// Every kind of factor, with every method on every linear back-end, ends at the same optimum.
#include <gtest/gtest.h>

#include "cairn/solver/optimize.hpp"
#include "datasets/simulate.hpp"

namespace cairn {
namespace {

class SolveWithSensor : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Sensors, SolveWithSensor, testing::ValuesIn(sensor_names()),
                         [](const auto& sensor) {
                           std::string name = sensor.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST_P(SolveWithSensor, ReachesTheSameOptimumWithEveryMethodAndLinearBackend) {
  const auto world =
      simulate({.world = World::kLandmarks, .poses = 48, .sensor = *find_sensor(GetParam())});
  ASSERT_TRUE(world);
  // From the truth: Gauss-Newton promises nothing from afar.
  Graph reference = world->true_graph();
  const double chi2 = optimize(reference).final_chi2;
  for (const LinearBackend linear :
       {LinearBackend::kMultifrontal, LinearBackend::kCholmod, LinearBackend::kEigen,
        LinearBackend::kPcg, LinearBackend::kCeres}) {
    if (!is_available(linear)) continue;
    for (const Method method :
         {Method::kLevenbergMarquardt, Method::kGaussNewton, Method::kDogleg}) {
      Graph graph = world->true_graph();
      const SolveSummary summary = optimize(graph, {.method = method, .linear = linear});
      EXPECT_EQ(summary.status, SolveStatus::kConverged)
          << to_string(linear) << ", method " << static_cast<int>(method) << ": "
          << to_string(summary.stop_reason);
      EXPECT_NEAR(summary.final_chi2, chi2, 1e-7 * chi2)
          << to_string(linear) << ", method " << static_cast<int>(method);
      EXPECT_LT(summary.final_chi2, summary.initial_chi2);
    }
  }
}

}  // namespace
}  // namespace cairn
