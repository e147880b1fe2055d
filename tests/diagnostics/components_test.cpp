// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/components.hpp"

#include <gtest/gtest.h>

#include "tests/diagnostics/small_graphs.hpp"

namespace cairn {
namespace {

TEST(Components, AreNamedByTheirSmallestIdAndComeInThatOrder) {
  Graph graph = test::chain({30, 31, 5, 7});
  test::add_between(graph, 30, 31);
  test::add_between(graph, 7, 5);
  const auto components = connected_components(graph);
  ASSERT_EQ(components.size(), 2u);
  EXPECT_EQ(components[0].smallest.value, 5u);
  EXPECT_EQ(components[1].smallest.value, 30u);
  EXPECT_EQ(components[1].variables, 2u);
  EXPECT_EQ(components[1].factors, 1u);
}

TEST(Components, KnowTheirGauge) {
  Graph graph = test::chain({0, 1, 2, 3, 4});
  test::add_between(graph, 0, 1);
  test::add_between(graph, 2, 3);
  graph.set_fixed(*graph.find(VariableId{3}), true);
  const auto components = connected_components(graph);
  ASSERT_EQ(components.size(), 3u);
  EXPECT_TRUE(components[0].needs_gauge());
  EXPECT_FALSE(components[1].needs_gauge());
  EXPECT_EQ(components[1].fixed, std::vector{VariableId{3}});
  EXPECT_FALSE(components[2].needs_gauge()) << "vertex 4 has no factor";
}

TEST(Components, AnAbsoluteMeasurementHoldsItsPart) {
  Graph graph = test::chain({0, 1});
  test::add_between(graph, 0, 1);
  ASSERT_TRUE(graph.add_factor(
      PriorSe2{.T_map_body_measured = {}, .information = Eigen::Matrix3d::Identity()},
      {VariableId{1}}));
  EXPECT_FALSE(connected_components(graph)[0].needs_gauge());
}

TEST(Components, NameTheSmallestPoseWhereTheSmallestIdIsALandmark) {
  Graph graph = test::chain({4, 6});
  ASSERT_TRUE(graph.add_point2(VariableId{1}, {0.0, 0.0}));
  test::add_between(graph, 4, 6);
  ASSERT_TRUE(graph.add_factor(LandmarkXy{.p_sensor_measured = {1.0, 0.0},
                                          .sensor = {},
                                          .information = Eigen::Matrix2d::Identity()},
                               {VariableId{6}, VariableId{1}}));
  const auto components = connected_components(graph);
  ASSERT_EQ(components.size(), 1u);
  EXPECT_EQ(components[0].smallest.value, 1u);
  EXPECT_EQ(components[0].smallest_pose->value, 4u);
}

}  // namespace
}  // namespace cairn
