// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/optimize.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

#include "cairn/factors/prior.hpp"
#include "tests/solver/small_problems.hpp"

namespace cairn {
namespace {

using test::bits;
using test::circle;
using test::Plane;
using test::RandomNumbers;
using test::Space;

template <class World>
class OptimizeTest : public ::testing::Test {};
struct WorldNames {
  template <class World>
  static std::string GetName(int) {
    return std::is_same_v<World, Plane> ? "Plane" : "Space";
  }
};
using Worlds = ::testing::Types<Plane, Space>;
TYPED_TEST_SUITE(OptimizeTest, Worlds, WorldNames);

// Landmarks seen from fixed poses: the error is linear in the landmarks.
TYPED_TEST(OptimizeTest, SolvesALinearProblemInOneStep) {
  Graph graph = circle<TypeParam>(8, 0, 12, 0.3, 0.0, 1);
  for (VariableSlot slot = 0; slot < 8; ++slot) graph.set_fixed(slot, true);
  RandomNumbers random(2);
  for (auto& p : TypeParam::points(graph.values())) p += random.vector<TypeParam::kPoint>(100.0);
  const SolveSummary summary = optimize(graph);
  EXPECT_EQ(summary.status, SolveStatus::kConverged);
  // One step, and at most one more that finds nothing left to gain.
  ASSERT_LE(summary.iterations.size(), 2u);
  EXPECT_LE(summary.iterations[0].chi2, summary.final_chi2 * (1.0 + 1e-12));
  EXPECT_TRUE(summary.gauge.empty());
}

TYPED_TEST(OptimizeTest, ClosesANoiseFreeRingToRounding) {
  Graph graph = circle<TypeParam>(40, 0, 0, 0.0, 0.1, 3);
  const SolveSummary summary = optimize(graph);
  EXPECT_EQ(summary.status, SolveStatus::kConverged) << to_string(summary.stop_reason);
  EXPECT_LT(summary.final_chi2, 1e-18);
  EXPECT_THAT(summary.gauge, ::testing::ElementsAre(VariableId{0}));
}

TYPED_TEST(OptimizeTest, ReachesTheSameOptimumWithEveryMethodAndLinearBackend) {
  const Graph start = circle<TypeParam>(20, 5, 8, 0.02, 0.05, 4);
  Graph reference = start;
  const double chi2 = optimize(reference).final_chi2;
  EXPECT_GT(chi2, 1e-3);
  for (const Method method : {Method::kLevenbergMarquardt, Method::kGaussNewton, Method::kDogleg}) {
    for (const LinearBackend linear :
         {LinearBackend::kMultifrontal, LinearBackend::kCholmod, LinearBackend::kEigen,
          LinearBackend::kPcg, LinearBackend::kCeres}) {
      if (!is_available(linear)) continue;
      Graph graph = start;
      const SolveSummary summary = optimize(graph, {.method = method, .linear = linear});
      EXPECT_EQ(summary.status, SolveStatus::kConverged)
          << static_cast<int>(method) << to_string(linear) << to_string(summary.stop_reason);
      EXPECT_NEAR(summary.final_chi2, chi2, 1e-8 * chi2)
          << static_cast<int>(method) << to_string(linear);
      EXPECT_EQ(summary.linear, linear);
    }
  }
}

TYPED_TEST(OptimizeTest, GivesTheSameBitsWithAnyNumberOfThreads) {
  for (const char* name : {"OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "OMP_PROC_BIND"})
    unsetenv(name);
  // Enough work for three threads: see threads_that_pay().
  constexpr int d = TypeParam::Between::kDimension;
  const Graph start = circle<TypeParam>(520000 / (d * d * d), 200, 100, 0.02, 0.02, 5);
  for (const auto kind :
       {RobustLoss::Kind::kNone, RobustLoss::Kind::kHuber, RobustLoss::Kind::kDcs}) {
    std::vector<double> expected;
    for (const int threads : {1, 2, 3}) {
      Graph graph = start;
      const SolveOptions options{
          .max_iterations = 4, .loss = RobustLoss(kind, 1.0), .threads = threads};
      const SolveSummary summary = optimize(graph, options);
      EXPECT_EQ(summary.threads, threads);
      std::vector<double> found = bits(graph.values());
      found.push_back(summary.final_chi2);
      found.push_back(summary.final_cost);
      if (threads == 1) expected = found;
      EXPECT_EQ(found, expected) << threads << " threads, loss " << static_cast<int>(kind);
    }
  }
}

TYPED_TEST(OptimizeTest, ReachesTheSameOptimumWithEveryKernelOfThisProcessor) {
  const Graph start = circle<TypeParam>(60, 20, 10, 0.02, 0.05, 11);
  Graph first = start;
  const double chi2 = optimize(first).final_chi2;
  for (const Kernel kernel : {Kernel::kPortable, Kernel::kAvx2, Kernel::kAvx512}) {
    if (!is_runnable(kernel)) continue;
    for (const InitMethod init : {InitMethod::kFile, InitMethod::kChordal}) {
      Graph graph = start;
      const SolveSummary summary = optimize(graph, {.kernel = kernel, .init = init});
      EXPECT_NEAR(summary.final_chi2, chi2, 1e-8 * chi2) << static_cast<int>(kernel);
    }
  }
}

TYPED_TEST(OptimizeTest, GivesTheSameBitsEveryTime) {
  Graph first = circle<TypeParam>(60, 20, 10, 0.02, 0.05, 6), second = first;
  optimize(first);
  optimize(second);
  EXPECT_EQ(bits(first.values()), bits(second.values()));
}

// Sums are taken in the order of the factors, so other orders differ by rounding only.
TYPED_TEST(OptimizeTest, DoesNotDependOnTheOrderOfFactors) {
  Graph forward = circle<TypeParam>(30, 10, 0, 0.02, 0.05, 7);
  Graph backward;
  for (std::size_t i = 0; i < 30; ++i)
    ASSERT_TRUE(TypeParam::add_pose(backward, i, TypeParam::poses(forward.values())[i]));
  const auto* batch = forward.find_batch<typename TypeParam::Between>();
  for (std::size_t i = batch->size(); i-- > 0;) {
    const auto indices = batch->variable_indices().subspan(2 * i, 2);
    ASSERT_TRUE(backward.add_factor(
        batch->factor(i), {VariableId{indices[0]}, VariableId{indices[1]}}, batch->kinds()[i]));
  }
  const double chi2 = optimize(forward).final_chi2;
  EXPECT_NEAR(optimize(backward).final_chi2, chi2, 1e-9 * chi2);
  for (std::size_t i = 0; i < 30; ++i) {
    const auto difference =
        (TypeParam::poses(forward.values())[i].inverse() * TypeParam::poses(backward.values())[i])
            .log();
    EXPECT_LT(difference.norm(), 1e-7) << "pose " << i;
  }
}

TYPED_TEST(OptimizeTest, LeavesChi2AloneWhenTheWholeGraphIsMoved) {
  Graph graph = circle<TypeParam>(30, 10, 10, 0.02, 0.05, 8);
  RandomNumbers random(9);
  const auto T_other_map = TypeParam::Pose::exp(random.vector<TypeParam::kPose>(5.0));
  Graph moved = graph;
  for (auto& T : TypeParam::poses(moved.values())) T = T_other_map * T;
  for (auto& p : TypeParam::points(moved.values())) p = T_other_map * p;
  for (const ErrorChart chart : {ErrorChart::kG2o, ErrorChart::kLog, ErrorChart::kGtsam}) {
    const double chi2 = compute_chi2(graph, chart);
    EXPECT_NEAR(compute_chi2(moved, chart), chi2, 1e-11 * chi2) << to_string(chart);
  }
  const double chi2 = optimize(graph).final_chi2;
  EXPECT_NEAR(optimize(moved).final_chi2, chi2, 1e-8 * chi2);
}

TYPED_TEST(OptimizeTest, TakesADuplicatedEdgeAsOneWithTwiceTheInformation) {
  Graph twice = circle<TypeParam>(20, 4, 0, 0.02, 0.05, 10), doubled = twice;
  RandomNumbers random(11);
  typename TypeParam::Between edge{};
  edge.T_a_b_measured = (TypeParam::on_circle(0.9).inverse() * TypeParam::on_circle(2.0))
                            .retract(random.vector<TypeParam::kPose>(0.1));
  edge.information = random.information<TypeParam::kPose>();
  ASSERT_TRUE(twice.add_factor(edge, {VariableId{3}, VariableId{11}}));
  ASSERT_TRUE(twice.add_factor(edge, {VariableId{3}, VariableId{11}}));
  edge.information *= 2.0;
  ASSERT_TRUE(doubled.add_factor(edge, {VariableId{3}, VariableId{11}}));
  const double chi2 = optimize(doubled).final_chi2;
  EXPECT_NEAR(optimize(twice).final_chi2, chi2, 1e-10 * chi2);
}

TYPED_TEST(OptimizeTest, KeepsFixedVariablesBitForBitAndNeedsNoGaugeThen) {
  Graph graph = circle<TypeParam>(20, 4, 3, 0.02, 0.05, 12);
  graph.set_fixed(7, true);
  graph.set_fixed(21, true);
  Graph before = graph;
  const SolveSummary summary = optimize(graph);
  EXPECT_TRUE(summary.gauge.empty());
  EXPECT_TRUE(summary.usable());
  EXPECT_EQ((TypeParam::poses(before.values())[7].inverse() * TypeParam::poses(graph.values())[7])
                .translation()
                .norm(),
            (TypeParam::poses(before.values())[7].inverse() * TypeParam::poses(before.values())[7])
                .translation()
                .norm());
  EXPECT_EQ(TypeParam::points(before.values())[1], TypeParam::points(graph.values())[1]);
}

TYPED_TEST(OptimizeTest, DownWeightsAWrongLoopWithEveryStrongLoss) {
  Graph clean = circle<TypeParam>(40, 12, 0, 0.002, 0.02, 13), with_outlier = clean;
  optimize(clean);
  typename TypeParam::Between wrong{};
  wrong.T_a_b_measured = TypeParam::Pose::exp(TypeParam::Pose::Tangent::Constant(1.5));
  wrong.information = 100.0 * decltype(wrong.information)::Identity();
  ASSERT_TRUE(with_outlier.add_factor(wrong, {VariableId{4}, VariableId{25}}, FactorKind::kLoop));
  const auto worst = [&](Graph& graph) {
    double error = 0.0;
    for (std::size_t i = 0; i < 40; ++i) {
      error = std::max(error, (TypeParam::poses(graph.values())[i].translation() -
                               TypeParam::poses(clean.values())[i].translation())
                                  .norm());
    }
    return error;
  };
  Graph plain = with_outlier;
  optimize(plain);
  const double without_loss = worst(plain);
  EXPECT_GT(without_loss, 0.3);
  using Kind = RobustLoss::Kind;
  // Not Huber: it only bounds the pull of an outlier, and this one is surer than its neighbors.
  for (const Kind kind : {Kind::kCauchy, Kind::kGemanMcClure, Kind::kTukey, Kind::kDcs}) {
    for (const bool loops_only : {false, true}) {
      Graph graph = with_outlier;
      const SolveSummary summary =
          optimize(graph, {.loss = RobustLoss(kind, 1.0), .loss_on_loops_only = loops_only});
      EXPECT_TRUE(summary.usable()) << static_cast<int>(kind) << to_string(summary.stop_reason);
      EXPECT_LT(summary.final_cost, 0.5 * summary.final_chi2) << static_cast<int>(kind);
      EXPECT_LT(worst(graph), 0.05 * without_loss)
          << static_cast<int>(kind) << " loops only: " << loops_only;
    }
  }
}

// Huber only bounds the pull of an outlier: many good loops outweigh a bounded one.
TYPED_TEST(OptimizeTest, StaysCloseToTheOptimumWithoutAnOutlierUnderHuber) {
  Graph clean = circle<TypeParam>(40, 40, 0, 0.02, 0.02, 15), with_outlier = clean;
  optimize(clean);
  typename TypeParam::Between wrong{};
  wrong.T_a_b_measured = TypeParam::Pose::exp(TypeParam::Pose::Tangent::Constant(1.5));
  wrong.information.setIdentity();
  ASSERT_TRUE(with_outlier.add_factor(wrong, {VariableId{4}, VariableId{25}}, FactorKind::kLoop));
  const auto worst_m = [&](const RobustLoss& loss) {
    Graph graph = with_outlier;
    EXPECT_TRUE(optimize(graph, {.loss = loss}).usable());
    double error_m = 0.0;
    for (std::size_t i = 0; i < 40; ++i) {
      error_m = std::max(error_m, (TypeParam::poses(graph.values())[i].translation() -
                                   TypeParam::poses(clean.values())[i].translation())
                                      .norm());
    }
    return error_m;
  };
  const double without_loss_m = worst_m({}), huber_m = worst_m({RobustLoss::Kind::kHuber, 1.0});
  EXPECT_GT(without_loss_m, 1.0);
  EXPECT_LT(huber_m, 0.1 * without_loss_m);
}

TYPED_TEST(OptimizeTest, LeavesOdometryUnderALossOnLoopsOnly) {
  Graph graph = circle<TypeParam>(10, 0, 0, 0.0, 0.2, 14);
  const RobustLoss loss(RobustLoss::Kind::kCauchy, 0.1);
  const EvaluationContext loops{.values = graph.values(), .loss = loss, .loss_on_loops_only = true};
  const auto* batch = graph.find_batch<typename TypeParam::Between>();
  const RangeCost odometry = batch->evaluate_cost(0, 9, loops);
  const RangeCost loop = batch->evaluate_cost(9, 10, loops);
  EXPECT_DOUBLE_EQ(odometry.cost, 0.5 * odometry.chi2);
  EXPECT_LT(loop.cost, 0.5 * loop.chi2);
}

}  // namespace
}  // namespace cairn
