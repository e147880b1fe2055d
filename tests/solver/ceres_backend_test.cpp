// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/ceres_backend.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "cairn/factors/between.hpp"
#include "cairn/solver/optimize.hpp"

namespace cairn {
namespace {

// A closed ring of `count` poses whose edges agree exactly; the start is off by `noise`.
Graph ring2(std::uint64_t count, double noise, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, noise);
  Graph graph;
  const double step = 2.0 * std::numbers::pi / static_cast<double>(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    const double angle = step * static_cast<double>(i);
    const Se2 truth(10.0 * std::cos(angle), 10.0 * std::sin(angle), angle + std::numbers::pi / 2.0);
    const Eigen::Vector3d off(normal(random), normal(random), normal(random));
    EXPECT_TRUE(graph.add_pose2({i}, i == 0 ? truth : truth.retract(off)));
  }
  const Se2 T_0_1(10.0 * std::sin(step), 10.0 * (1.0 - std::cos(step)), step);
  for (std::uint64_t i = 0; i < count; ++i) {
    const BetweenSe2 edge{T_0_1, Eigen::Vector3d(100.0, 100.0, 1000.0).asDiagonal()};
    const FactorKind kind = i + 1 < count ? FactorKind::kOdometry : FactorKind::kLoop;
    EXPECT_TRUE(graph.add_factor(edge, {VariableId{i}, VariableId{(i + 1) % count}}, kind));
  }
  return graph;
}

// The gauge is the pose with the smallest id.
SolveSummary solve(Graph& graph, const SolveOptions& options = {}) {
  SolveSummary summary;
  solve_with_ceres(Problem(graph), options, graph.values(), summary);
  return summary;
}

TEST(CeresBackend, ClosesANoiseFreeRingToRounding) {
  Graph graph = ring2(40, 0.1, 1);
  const SolveSummary summary = solve(graph);
  EXPECT_EQ(summary.status, SolveStatus::kConverged) << to_string(summary.stop_reason);
  EXPECT_TRUE(summary.usable());
  EXPECT_LT(summary.final_chi2, 1e-15);
  EXPECT_EQ(summary.final_chi2, compute_chi2(graph));
  EXPECT_FALSE(summary.iterations.empty());
  EXPECT_EQ(summary.linear, LinearBackend::kCeres);
}

TEST(CeresBackend, ConvergesQuadraticallyInSpaceSoItsJacobiansAreRight) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto random_tangent = [&](double scale) -> Vector6d {
    return scale * Vector6d::NullaryExpr([&] { return normal(random); });
  };
  Graph graph;
  std::vector<Se3> truth;
  for (std::uint64_t i = 0; i < 12; ++i) {
    truth.push_back(Se3::exp(random_tangent(1.0)));
    ASSERT_TRUE(graph.add_pose3({i}, i == 0 ? truth[0] : truth[i].retract(random_tangent(0.1))));
  }
  const Matrix6d root = Matrix6d::NullaryExpr([&] { return normal(random); });
  const Matrix6d information = root * root.transpose() + Matrix6d::Identity();
  for (std::uint64_t i = 0; i < 12; ++i) {
    for (const std::uint64_t j : {(i + 1) % 12, (i + 5) % 12}) {
      const BetweenSe3 edge{truth[i].inverse() * truth[j], information};
      ASSERT_TRUE(graph.add_factor(edge, {VariableId{i}, VariableId{j}}));
    }
  }
  const SolveSummary summary = solve(graph);
  EXPECT_LT(summary.final_chi2, 1e-15);
  EXPECT_LE(summary.iterations.size(), 8u);  // a wrong Jacobian converges linearly at best
}

TEST(CeresBackend, KeepsHeldVariablesBitForBit) {
  Graph graph = ring2(10, 0.1, 5);
  graph.set_fixed(4, true);
  const Se2 before = graph.values().pose2[4];
  solve(graph);
  EXPECT_EQ(graph.values().pose2[4].to_vector(), before.to_vector());
}

TEST(CeresBackend, CountsHalfOfRhoAsCostAndNeverRobustifiesChi2) {
  Graph graph = ring2(20, 0.05, 7);
  const BetweenSe2 wrong_loop{Se2(5.0, 5.0, 1.0),
                              Eigen::Vector3d(100.0, 100.0, 1000.0).asDiagonal()};
  ASSERT_TRUE(graph.add_factor(wrong_loop, {VariableId{2}, VariableId{12}}, FactorKind::kLoop));
  const SolveOptions options{.loss = RobustLoss(RobustLoss::Kind::kCauchy, 1.0),
                             .loss_on_loops_only = true};
  const SolveSummary summary = solve(graph, options);
  EXPECT_TRUE(summary.usable());
  double cost = 0.0;
  const EvaluationContext context{
      .values = graph.values(), .loss = options.loss, .loss_on_loops_only = true};
  for (const auto& batch : graph.batches())
    cost += batch->evaluate_cost(0, batch->size(), context).cost;
  EXPECT_DOUBLE_EQ(summary.final_cost, cost);
  EXPECT_DOUBLE_EQ(summary.final_chi2, compute_chi2(graph));
  EXPECT_DOUBLE_EQ(summary.iterations.back().chi2, summary.final_chi2);
  EXPECT_GT(summary.final_chi2,
            10.0 * summary.final_cost);  // the wrong loop is nearly switched off
}

TEST(CeresBackend, SaysThatTheUserStoppedIt) {
  Graph graph = ring2(40, 0.2, 9);
  const SolveSummary summary =
      solve(graph, {.on_iteration = [](int, const IterationReport&) { return false; }});
  EXPECT_EQ(summary.stop_reason, StopReason::kInterrupted);
  EXPECT_EQ(summary.iterations.size(), 1u);
  EXPECT_LT(summary.final_chi2, summary.initial_chi2);
}

TEST(CeresBackend, IsNotUsableFarFromTheOptimumAtTheIterationLimit) {
  Graph graph = ring2(40, 0.4, 11);
  const SolveSummary summary = solve(graph, {.max_iterations = 1});
  EXPECT_EQ(summary.status, SolveStatus::kIterationLimit);
  EXPECT_FALSE(summary.usable());
}

}  // namespace
}  // namespace cairn
