// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/determination.hpp"

#include <gtest/gtest.h>

#include "cairn/factors/range.hpp"
#include "tests/diagnostics/small_graphs.hpp"

namespace cairn {
namespace {

void add_bearing(Graph& graph, std::uint64_t pose, std::uint64_t landmark) {
  ASSERT_TRUE(graph.add_factor(
      BearingXy{.bearing_rad_measured = 0.5, .information = BearingXy{}.information.Ones()},
      {VariableId{pose}, VariableId{landmark}}));
}

TEST(Determination, FindsNothingInAChain) {
  Graph graph = test::chain({0, 1, 2});
  test::add_between(graph, 0, 1);
  test::add_between(graph, 1, 2);
  EXPECT_TRUE(find_undetermined_variables(graph).empty());
}

TEST(Determination, FindsAVariableWithoutFactors) {
  Graph graph = test::chain({0, 1, 2});
  test::add_between(graph, 0, 1);
  const auto found = find_undetermined_variables(graph);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].slot, 2u);
  EXPECT_EQ(found[0].factors, 0u);
  EXPECT_EQ(found[0].free_directions.cols(), 3);
}

TEST(Determination, ALandmarkSeenByOneBearingIsFreeAlongTheRay) {
  Graph graph = test::chain({0, 1});
  test::add_between(graph, 0, 1);
  ASSERT_TRUE(graph.add_point2(VariableId{7}, {3.0, 4.0}));
  add_bearing(graph, 0, 7);
  const auto found = find_undetermined_variables(graph);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(graph.variables()[found[0].slot].id.value, 7u);
  ASSERT_EQ(found[0].free_directions.cols(), 1);
  EXPECT_NEAR(std::abs(found[0].free_directions.col(0).dot(Eigen::Vector2d(0.6, 0.8))), 1.0, 1e-12);
}

TEST(Determination, ASecondBearingFromElsewhereDeterminesTheLandmark) {
  Graph graph = test::chain({0, 1});
  test::add_between(graph, 0, 1);
  ASSERT_TRUE(graph.add_point2(VariableId{7}, {3.0, 4.0}));
  add_bearing(graph, 0, 7);
  add_bearing(graph, 1, 7);
  EXPECT_TRUE(find_undetermined_variables(graph).empty());
}

TEST(Determination, DoesNotDependOnTheScaleOfTheInformation) {
  for (const double scale : {1e-8, 1.0, 1e8}) {
    Graph graph = test::chain({0, 1});
    test::add_between(graph, 0, 1);
    ASSERT_TRUE(graph.add_point2(VariableId{7}, {3.0, 4.0}));
    const Eigen::Matrix2d information = scale * Eigen::Vector2d(1.0, 1e-6).asDiagonal();
    ASSERT_TRUE(graph.add_factor(
        LandmarkXy{.p_sensor_measured = {3.0, 4.0}, .sensor = {}, .information = information},
        {VariableId{0}, VariableId{7}}));
    EXPECT_TRUE(find_undetermined_variables(graph).empty()) << "scale " << scale;
  }
}

TEST(Determination, LeavesFixedVariablesAlone) {
  Graph graph = test::chain({0, 1});
  graph.set_fixed(0, true);
  graph.set_fixed(1, true);
  EXPECT_TRUE(find_undetermined_variables(graph).empty());
}

}  // namespace
}  // namespace cairn
