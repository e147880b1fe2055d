// SPDX-License-Identifier: BSD-3-Clause
// Every way in which the loop ends, provoked.
#include <gtest/gtest.h>

#include <limits>

#include "cairn/solver/optimize.hpp"
#include "tests/solver/small_problems.hpp"

namespace cairn {
namespace {

using test::circle;
using test::Plane;
using test::Space;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr Method kMethods[] = {Method::kLevenbergMarquardt, Method::kGaussNewton, Method::kDogleg};

/// The position of a point, told in a way that no optimizer can use. e = p_map - measured, m.
struct BrokenPosition {
  static constexpr std::string_view kName = "broken_position";
  using Variables = Signature<VariableType::kPoint2>;
  static constexpr int kDimension = 2;
  static constexpr bool kAbsolute = true;

  enum class Fault { kJacobianNotFinite, kJacobianOfWrongSign, kDefinedAtStartOnly };
  Fault fault;
  Eigen::Vector2d p_map_start, p_map_measured;
  Eigen::Matrix2d information = Eigen::Matrix2d::Identity();

  Eigen::Vector2d error(const Eigen::Vector2d& p_map, ErrorChart /*chart*/,
                        Eigen::Matrix2d* J_e_p) const {
    if (J_e_p) J_e_p->setIdentity();
    if (J_e_p && fault == Fault::kJacobianNotFinite) *J_e_p *= kNaN;
    if (J_e_p && fault == Fault::kJacobianOfWrongSign) *J_e_p *= -1.0;
    if (fault == Fault::kDefinedAtStartOnly && p_map != p_map_start) return {kNaN, kNaN};
    return p_map - p_map_measured;
  }
};

const Eigen::Vector2d kStart(3.0, 4.0);

Graph broken(BrokenPosition::Fault fault) {
  Graph graph;
  EXPECT_TRUE(graph.add_point2({1}, kStart));
  EXPECT_TRUE(
      graph.add_factor(BrokenPosition{fault, kStart, Eigen::Vector2d(5.0, 1.0)}, {VariableId{1}}));
  return graph;
}

TEST(StopReason, IsSmallStepWhereTheStartIsTheOptimumToTheLastDigits) {
  for (const Method method : kMethods) {
    Graph graph = circle<Space>(20, 5, 0, 0.0, 1e-12, 1);
    const SolveSummary summary = optimize(graph, {.method = method});
    EXPECT_EQ(summary.stop_reason, StopReason::kSmallStep) << to_string(summary.stop_reason);
    EXPECT_EQ(summary.status, SolveStatus::kConverged);
    EXPECT_EQ(summary.iterations.size(), 1u);
  }
}

TEST(StopReason, IsGradientWhereThereIsNothingToDo) {
  Graph graph = circle<Plane>(20, 5, 0, 0.0, 0.0, 2);
  const SolveSummary summary = optimize(graph);
  EXPECT_EQ(summary.stop_reason, StopReason::kGradient) << to_string(summary.stop_reason);
  EXPECT_EQ(summary.status, SolveStatus::kConverged);
  EXPECT_TRUE(summary.iterations.empty());
}

TEST(StopReason, IsSmallDecreaseOnOrdinaryGraphs) {
  for (const Method method : kMethods) {
    Graph graph = circle<Space>(20, 5, 4, 0.05, 0.05, 3);
    const SolveSummary summary = optimize(graph, {.method = method});
    EXPECT_EQ(summary.stop_reason, StopReason::kSmallDecrease) << to_string(summary.stop_reason);
    EXPECT_EQ(summary.status, SolveStatus::kConverged);
  }
}

// Damping makes any step small. That it promises little then does not mean that little is left.
TEST(StopReason, IsLambdaExhaustedWhereNoStepGainsAnything) {
  for (const auto fault :
       {BrokenPosition::Fault::kJacobianOfWrongSign, BrokenPosition::Fault::kDefinedAtStartOnly}) {
    for (const Method method : {Method::kLevenbergMarquardt, Method::kDogleg}) {
      Graph graph = broken(fault);
      const SolveSummary summary = optimize(graph, {.method = method});
      EXPECT_EQ(summary.stop_reason, StopReason::kLambdaExhausted)
          << to_string(summary.stop_reason) << ", fault " << static_cast<int>(fault);
      EXPECT_EQ(summary.status, SolveStatus::kFailed);
      EXPECT_FALSE(summary.usable());
      EXPECT_EQ(graph.values().point2[0], kStart);
    }
  }
}

TEST(StopReason, IsNotFiniteWhereTheStartHasNoGradient) {
  for (const LinearBackend linear :
       {LinearBackend::kMultifrontal, LinearBackend::kCholmod, LinearBackend::kEigen}) {
    for (const Method method : kMethods) {
      Graph graph = broken(BrokenPosition::Fault::kJacobianNotFinite);
      const SolveSummary summary = optimize(graph, {.method = method, .linear = linear});
      EXPECT_EQ(summary.stop_reason, StopReason::kNotFinite) << to_string(summary.stop_reason);
      EXPECT_EQ(summary.status, SolveStatus::kFailed);
      EXPECT_FALSE(summary.usable());
      EXPECT_TRUE(summary.under_constrained.empty());
      EXPECT_EQ(graph.values().point2[0], kStart);
    }
  }
}

TEST(StopReason, IterationLimitIsNotUsableFarFromTheOptimum) {
  Graph graph = circle<Plane>(40, 0, 0, 0.02, 0.4, 2);
  const SolveSummary summary = optimize(graph, {.max_iterations = 1});
  EXPECT_EQ(summary.stop_reason, StopReason::kIterationLimit);
  EXPECT_EQ(summary.status, SolveStatus::kIterationLimit);
  EXPECT_FALSE(summary.usable());
  EXPECT_EQ(summary.iterations.size(), 1u);
}

TEST(StopReason, IterationLimitIsUsableWhereNothingIsLeftToGain) {
  Graph graph = circle<Plane>(40, 0, 0, 0.02, 0.05, 3);
  optimize(graph);
  const SolveSummary summary = optimize(graph, {.max_iterations = 0});
  EXPECT_EQ(summary.status, SolveStatus::kIterationLimit);
  EXPECT_TRUE(summary.usable());
}

TEST(StopReason, InterruptedKeepsTheBestIterateSoFar) {
  Graph graph = circle<Plane>(40, 0, 0, 0.02, 0.4, 4);
  std::vector<int> numbers;
  const SolveSummary summary = optimize(graph, {.on_iteration = [&](int n, const IterationReport&) {
                                          numbers.push_back(n);
                                          return n < 2;
                                        }});
  EXPECT_EQ(summary.stop_reason, StopReason::kInterrupted);
  EXPECT_EQ(numbers, (std::vector<int>{1, 2}));
  EXPECT_LE(summary.final_chi2, summary.initial_chi2);
  EXPECT_NEAR(compute_chi2(graph), summary.final_chi2, 1e-12 * summary.final_chi2);
}

TEST(StopReason, NotFiniteInputIsRefusedAndLeftAlone) {
  Graph graph = circle<Plane>(10, 0, 0, 0.02, 0.05, 5);
  graph.values().pose2[4] = Se2(kNaN, 0.0, 0.0);
  const Se2 other = graph.values().pose2[5];
  const SolveSummary summary = optimize(graph);
  EXPECT_EQ(summary.stop_reason, StopReason::kNotFinite);
  EXPECT_EQ(summary.status, SolveStatus::kFailed);
  EXPECT_FALSE(summary.usable());
  EXPECT_EQ(graph.values().pose2[5].to_vector(), other.to_vector());
}

}  // namespace
}  // namespace cairn
