// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/factors/build_transaction.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "cairn/factors/factor_codec.hpp"

namespace cairn {
namespace {

// What the builders write is what the codec makes of a graph with the same pose and factor.
template <class Pose, int N>
void expect_the_codecs_numbers(const Pose& T_map_a, const Pose& T_a_b, VariableType type) {
  using Information = Eigen::Matrix<double, N, N>;
  Information information = Information::Identity() * 5.0;
  information(0, 1) = information(1, 0) = 0.5;
  const NodeId a{{"r", 1}, 1}, b{{"r", 1}, 2};
  Transaction built;
  add_pose(built, a, T_map_a, 7);
  add_pose(built, b, T_map_a * T_a_b);
  add_between(built, a, b, T_a_b, information, FactorKind::kLoop);
  EXPECT_EQ(built.variables[0].stamp_ns, 7);
  EXPECT_EQ(built.factors[0].kind, FactorKind::kLoop);
  EXPECT_FALSE(find_fault(built.factors[0]));
  Graph graph;
  for (std::uint64_t id : {1, 2}) {
    ASSERT_FALSE(find_fault(type, built.variables[id - 1].start));
    const auto slot = add_variable(graph, VariableId{id}, type, built.variables[id - 1].start);
    ASSERT_TRUE(slot);
    EXPECT_EQ(describe_value(graph, *slot), built.variables[id - 1].start);
  }
  const VariableId ids[] = {VariableId{1}, VariableId{2}};
  const auto factor = add_factor(graph, built.factors[0], ids);
  ASSERT_TRUE(factor);
  const NewFactor described = describe_factor(graph, *factor);
  EXPECT_EQ(described.type, built.factors[0].type);
  ASSERT_EQ(described.numbers.size(), built.factors[0].numbers.size());
  // The graph holds the square root of the information.
  for (std::size_t i = 0; i < described.numbers.size(); ++i)
    EXPECT_NEAR(described.numbers[i], built.factors[0].numbers[i], 1e-12) << i;
}

TEST(BuildTransaction, WritesPosesInThePlaneAsTheCodecDoes) {
  expect_the_codecs_numbers<Se2, 3>({1.0, 2.0, 0.5}, {0.3, -0.2, -2.0}, VariableType::kPose2);
}

TEST(BuildTransaction, WritesPosesInSpaceAsTheCodecDoes) {
  const Se3 a(So3(Eigen::Quaterniond(0.6, 0.0, 0.8, 0.0)), {1.0, 2.0, 3.0});
  const Se3 b(So3(Eigen::Quaterniond(-0.6, 0.8, 0.0, 0.0)), {0.1, 0.2, 0.3});
  expect_the_codecs_numbers<Se3, 6>(a, b, VariableType::kPose3);
}

TEST(BuildTransaction, AddsAFixInTheFrameAtTheDatum) {
  const Geodetic datum{47.0, 8.0, 400.0};
  const Eigen::Matrix3d information = Eigen::Vector3d(4.0, 3.0, 1.0).asDiagonal();
  Transaction built;
  const NodeId node{{"r", 1}, 1};
  add_gnss(built, node, {0.1, 0.2, 0.3}, datum, information, datum);
  // A hundred kilometres to the north the vertical leans by almost a degree.
  add_gnss(built, node, {}, {47.9, 8.0, 400.0}, information, datum);
  for (const NewFactor& factor : built.factors) {
    EXPECT_FALSE(find_fault(factor));
    EXPECT_EQ(datum_of(factor), datum);
  }
  const auto& here = built.factors[0].numbers;
  const std::vector<double> expected{0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 3.0, 0.0, 1.0};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(here[i], expected[i], 1e-9) << i;
  const auto& there = built.factors[1].numbers;
  EXPECT_NEAR(there[4], 100'070.0, 20.0);
  EXPECT_NEAR(there[5], -785.0, 2.0);  // below the horizon
  EXPECT_NEAR(there[6], 4.0, 1e-9);
  const double lean = 0.9 * 3.14159265358979 / 180.0;
  EXPECT_NEAR(std::abs(there[10]), (3.0 - 1.0) * std::sin(lean) * std::cos(lean), 1e-9);
}

}  // namespace
}  // namespace cairn
