// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>

#include "cairn/factors/bearing.hpp"
#include "cairn/factors/gnss.hpp"
#include "cairn/solver/optimize.hpp"
#include "tests/solver/small_problems.hpp"

namespace cairn {
namespace {

using test::circle;
using test::Plane;

Eigen::Matrix<double, 1, 1> scalar(double x) { return Eigen::Matrix<double, 1, 1>(x); }

const UnderConstrainedVariable* named(const SolveSummary& summary, std::uint64_t id) {
  const auto& all = summary.under_constrained;
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const auto& v) { return v.id == VariableId{id}; });
  return found == all.end() ? nullptr : &*found;
}

void expect_partial(const SolveSummary& summary, std::size_t names) {
  EXPECT_EQ(summary.status, SolveStatus::kPartiallyConstrained) << to_string(summary.stop_reason);
  EXPECT_TRUE(summary.usable());
  EXPECT_EQ(summary.under_constrained.size(), names);
  for (const auto& [id, directions] : summary.under_constrained) {
    const Eigen::MatrixXd product = directions.transpose() * directions;
    EXPECT_GT(directions.cols(), 0) << id.value;
    EXPECT_LT((product - Eigen::MatrixXd::Identity(product.rows(), product.cols())).norm(), 1e-12)
        << id.value;
  }
}

// A ring that is solved to rounding whatever hangs on to it.
Graph ring() { return circle<Plane>(20, 4, 0, 0.0, 0.05, 1); }

TEST(UnderConstrained, LandmarkOfOneBearingIsNamedWithItsRayAndStays) {
  Graph graph = ring();
  const Eigen::Vector2d start(3.0, 1.0);
  ASSERT_TRUE(graph.add_point2({1000}, start));
  ASSERT_TRUE(graph.add_factor(BearingXy{0.3, scalar(100.0)}, {VariableId{4}, VariableId{1000}}));
  const SolveSummary summary = optimize(graph);
  expect_partial(summary, 1);
  ASSERT_TRUE(named(summary, 1000));
  EXPECT_EQ(named(summary, 1000)->free_directions.cols(), 1);
  EXPECT_EQ(graph.values().point2[0], start);
  EXPECT_LT(optimize(graph).final_chi2, 1e-18);
}

TEST(UnderConstrained, IsolatedVariablesAreNamedAndStay) {
  Graph graph = ring();
  ASSERT_TRUE(graph.add_point2({1000}, Eigen::Vector2d(3.0, 1.0)));
  ASSERT_TRUE(graph.add_point2({1001}, Eigen::Vector2d(-3.0, 1.0)));
  const SolveSummary summary = optimize(graph);
  expect_partial(summary, 2);
  ASSERT_TRUE(named(summary, 1001));
  EXPECT_EQ(named(summary, 1001)->free_directions.cols(), 2);
  EXPECT_EQ(graph.values().point2[1], Eigen::Vector2d(-3.0, 1.0));
  EXPECT_EQ(summary.components, 3);
  EXPECT_LT(summary.final_chi2, 1e-18);
}

TEST(UnderConstrained, PoseOfASemidefiniteEdgeAndThePoseBehindItAreNamed) {
  Graph graph = ring();
  const Se2 first(11.0, 1.0, 0.2), second(12.0, 2.0, 0.4);
  ASSERT_TRUE(graph.add_pose2({100}, first));
  ASSERT_TRUE(graph.add_pose2({101}, second));
  const BetweenSe2 no_heading{Se2(1.0, 0.0, 0.0), Eigen::Vector3d(1.0, 1.0, 0.0).asDiagonal()};
  const BetweenSe2 full{Se2(1.0, 0.0, 0.0), Eigen::Matrix3d::Identity()};
  ASSERT_TRUE(graph.add_factor(no_heading, {VariableId{3}, VariableId{100}}));
  ASSERT_TRUE(graph.add_factor(full, {VariableId{100}, VariableId{101}}));
  const SolveSummary summary = optimize(graph);
  expect_partial(summary, 2);
  EXPECT_TRUE(named(summary, 100));
  EXPECT_TRUE(named(summary, 101));
  EXPECT_EQ(graph.values().pose2[20].to_vector(), first.to_vector());
  EXPECT_EQ(graph.values().pose2[21].to_vector(), second.to_vector());
  EXPECT_LT(summary.final_chi2, 1e-18);
}

TEST(UnderConstrained, ComponentTiedByOneAntennaTurnsAroundItAndIsOtherwiseSolved) {
  Graph graph = ring();
  const Eigen::Vector2d antenna(100.0, 50.0);
  ASSERT_TRUE(graph.add_factor(
      GnssSe2{Eigen::Vector2d::Zero(), antenna, Eigen::Matrix2d::Identity()}, {VariableId{6}}));
  const SolveSummary summary = optimize(graph);
  expect_partial(summary, 1);
  EXPECT_EQ(summary.under_constrained[0].free_directions.cols(), 1);
  EXPECT_TRUE(summary.gauge.empty());
  EXPECT_LT(summary.final_chi2, 1e-16);
  EXPECT_LT((graph.values().pose2[6].translation() - antenna).norm(), 1e-8);
}

TEST(UnderConstrained, EachComponentWithoutATieGetsItsOwnGauge) {
  Graph graph = ring();
  for (const std::uint64_t first : {100, 200}) {
    ASSERT_TRUE(graph.add_pose2({first + 1}, Se2(1.0, 2.0, 0.3)));
    ASSERT_TRUE(graph.add_pose2({first}, Se2(4.0, 2.0, 0.3)));
    const BetweenSe2 edge{Se2(1.0, 0.0, 0.0), Eigen::Matrix3d::Identity()};
    ASSERT_TRUE(graph.add_factor(edge, {VariableId{first}, VariableId{first + 1}}));
  }
  graph.set_fixed(*graph.find({201}), true);
  const Graph before = graph;
  const SolveSummary summary = optimize(graph);
  EXPECT_EQ(summary.status, SolveStatus::kConverged);
  EXPECT_EQ(summary.components, 3);
  EXPECT_EQ(summary.gauge, (std::vector<VariableId>{{0}, {100}}));
  EXPECT_LT(summary.final_chi2, 1e-18);
  for (const std::uint64_t id : {0, 100, 201}) {
    const std::uint32_t index = graph.variables()[*graph.find({id})].index;
    EXPECT_EQ(graph.values().pose2[index].to_vector(), before.values().pose2[index].to_vector());
  }
}

TEST(UnderConstrained, AGraphOfPointsAloneIsNamedWhole) {
  Graph graph;
  ASSERT_TRUE(graph.add_point2({1}, Eigen::Vector2d(3.0, 1.0)));
  ASSERT_TRUE(graph.add_point3({2}, Eigen::Vector3d(3.0, 1.0, 0.0)));
  const SolveSummary summary = optimize(graph);
  EXPECT_EQ(summary.under_constrained.size(), 2u);
  EXPECT_EQ(summary.final_chi2, 0.0);
  EXPECT_EQ(graph.values().point2[0], Eigen::Vector2d(3.0, 1.0));
}

TEST(Optimize, TakesAnEmptyGraphAndOneThatIsHeldWhole) {
  Graph empty;
  EXPECT_TRUE(optimize(empty).usable());
  Graph held = ring();
  for (VariableSlot slot = 0; slot < 20; ++slot) held.set_fixed(slot, true);
  const double chi2 = compute_chi2(held);
  const SolveSummary summary = optimize(held);
  EXPECT_TRUE(summary.usable());
  EXPECT_NEAR(summary.final_chi2, chi2, 1e-12 * chi2);
}

TEST(Optimize, NeverReturnsWorseThanTheStartWithAnyMethod) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    for (const Method method :
         {Method::kLevenbergMarquardt, Method::kGaussNewton, Method::kDogleg}) {
      Graph graph = circle<Plane>(30, 10, 5, 0.1, 3.0, seed);
      const double before = compute_chi2(graph);
      const SolveSummary summary = optimize(graph, {.method = method, .max_iterations = 15});
      EXPECT_LE(compute_chi2(graph), before * (1.0 + 1e-12)) << "seed " << seed;
      EXPECT_NEAR(compute_chi2(graph), summary.final_chi2, 1e-10 * summary.final_chi2);
    }
  }
}

}  // namespace
}  // namespace cairn
