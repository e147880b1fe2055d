// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/loop_trial.hpp"

#include <gtest/gtest.h>

#include "cairn/factors/between.hpp"
#include "cairn/solver/optimize.hpp"

namespace cairn {
namespace {

// A straight drive where each pose is tied to the seventh before it: of a map so small a false loop
// bends all loops there are.
struct Drive {
  Graph graph;

  Drive() {
    for (std::uint64_t i = 0; i < 30; ++i) {
      EXPECT_TRUE(graph.add_pose2(VariableId{i}, Se2(static_cast<double>(i), 0.0, 0.0)));
      if (i >= 1) tie(i - 1, i, 1.0, FactorKind::kOdometry);
      if (i >= 7) tie(i - 7, i, 7.0, FactorKind::kLoop);
    }
  }
  void tie(std::uint64_t a, std::uint64_t b, double metres, FactorKind kind) {
    const BetweenSe2 factor{Se2(metres, 0.01, 0.0),
                            Eigen::Vector3d(100.0, 100.0, 400.0).asDiagonal()};
    EXPECT_TRUE(graph.add_factor(factor, {VariableId{a}, VariableId{b}}, kind));
  }
  // With one more loop from 2 to 25.
  LoopTrial with(double metres) {
    Graph before = graph;
    const double chi2 = optimize(before).final_chi2;
    Graph all = graph;
    const BetweenSe2 loop{Se2(metres, 0.0, 0.0), Eigen::Vector3d(100.0, 100.0, 400.0).asDiagonal()};
    EXPECT_TRUE(all.add_factor(loop, {VariableId{2}, VariableId{25}}, FactorKind::kLoop));
    return try_loops(all, {all.factor_count() - 1}, {chi2, before.values()});
  }
};

TEST(LoopTrial, PassesWhatFits) { EXPECT_TRUE(Drive().with(23.05).passed); }

TEST(LoopTrial, DoesNotTakeForNoiseWhatAFalseLoopBends) {
  const LoopTrial trial = Drive().with(1.0);
  EXPECT_FALSE(trial.passed);
  EXPECT_GT(trial.increase, 100.0 * trial.threshold);
}

}  // namespace
}  // namespace cairn
