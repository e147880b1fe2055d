// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/factors/factor_codec.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <string>

namespace cairn {
namespace {

// Numbers that every type takes: unit quaternions are made where a pose in space may stand.
std::vector<double> random_numbers(const FactorTypeInfo& info, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const bool in_space = info.signature[0] == VariableType::kPose3;
  std::vector<double> numbers(info.numbers);
  for (double& x : numbers) x = 0.3 * normal(random);
  const auto unit_quaternion_at = [&](std::size_t first) {
    Eigen::Map<Eigen::Vector4d> q(numbers.data() + first);
    q = Eigen::Vector4d(q).normalized();
    if (q.w() < 0.0) q = -Eigen::Vector4d(q);
  };
  const std::string name(info.name);
  if (in_space) {
    if (name == "between_se3") unit_quaternion_at(3);
    if (name == "prior_se3") unit_quaternion_at(3), unit_quaternion_at(10);
    if (name == "landmark_xyz") unit_quaternion_at(6);
    if (name == "between_offset_se3")
      unit_quaternion_at(3), unit_quaternion_at(10), unit_quaternion_at(17);
  }
  // The information: diagonally dominant.
  for (std::size_t triangle : {21U, 10U, 6U, 3U, 1U}) {
    static const std::map<std::string, std::size_t> kSizes{{"between_se2", 6},
                                                           {"between_se3", 21},
                                                           {"prior_se2", 6},
                                                           {"prior_se3", 21},
                                                           {"prior_xy", 3},
                                                           {"landmark_xy", 3},
                                                           {"landmark_xyz", 6},
                                                           {"between_offset_se2", 6},
                                                           {"between_offset_se3", 21},
                                                           {"bearing_xy", 1},
                                                           {"range_xy", 1},
                                                           {"range_xyz", 1},
                                                           {"range_bearing_xy", 3},
                                                           {"range_bearing_xyz", 6},
                                                           {"gnss_se2", 3},
                                                           {"gnss_se3", 6},
                                                           {"altitude", 1},
                                                           {"yaw_se2", 1},
                                                           {"yaw_se3", 1},
                                                           {"gravity", 3}};
    if (kSizes.at(name) != triangle) continue;
    const int n = static_cast<int>(std::sqrt(2.0 * static_cast<double>(triangle)));
    std::size_t at = info.numbers - triangle;
    for (int row = 0; row < n; ++row) {
      numbers[at] = 20.0 + row;
      at += static_cast<std::size_t>(n - row);
    }
  }
  return numbers;
}

TEST(FactorCodec, GivesBackWhatItTook) {
  std::mt19937 random(3);
  ASSERT_EQ(factor_types().size(), 22U);
  for (const FactorTypeInfo& info : factor_types()) {
    SCOPED_TRACE(info.name);
    if (info.at_datum) continue;
    Graph graph;
    NewFactor factor;
    factor.type = info.type;
    factor.kind = FactorKind::kLoop;
    factor.numbers = random_numbers(info, random);
    std::vector<VariableId> ids;
    for (std::uint64_t k = 0; k < info.signature.size(); ++k) {
      ids.push_back({10 + k});
      factor.nodes.push_back({{"r", 1}, 10 + k});
      std::vector<double> start(value_numbers(info.signature[k]), 0.0);
      if (info.signature[k] == VariableType::kPose3) start[6] = 1.0;
      ASSERT_TRUE(add_variable(graph, ids[k], info.signature[k], start));
    }
    const auto fault = find_fault(factor);
    ASSERT_FALSE(fault) << fault->reason;
    const Result<FactorRef> added = add_factor(graph, factor, ids);
    ASSERT_TRUE(added) << added.error().to_string();
    const NewFactor described = describe_factor(graph, *added);
    EXPECT_EQ(described.type, factor.type);
    EXPECT_EQ(described.kind, factor.kind);
    EXPECT_EQ(described.numbers, factor.numbers);
  }
}

TEST(FactorCodec, RefusesQuaternionsThatAreNotOfUnitLength) {
  NewFactor factor;
  factor.type = FactorType{2};
  factor.nodes = {{{"r", 1}, 1}, {{"r", 1}, 2}};
  factor.numbers.assign(28, 0.0);
  const auto fault = find_fault(factor);
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->reason, "a quaternion is not of unit length (1e-3)");
  factor.numbers[6] = 1.0;
  EXPECT_FALSE(find_fault(factor));
}

TEST(FactorCodec, KeepsTheDatumOfGnssAndAddsTheFactorAsWithoutIt) {
  std::mt19937 random(4);
  const Geodetic datum{47.25, 8.5, 408.0};
  for (const int type : {15, 16}) {
    NewFactor plain;
    plain.type = static_cast<FactorType>(type);
    const FactorTypeInfo& info = *find_factor_type(plain.type);
    plain.nodes = {{{"r", 1}, 1}};
    plain.numbers = random_numbers(info, random);
    EXPECT_FALSE(datum_of(plain));
    NewFactor factor = plain;
    ASSERT_TRUE(set_datum(factor, datum));
    EXPECT_EQ(static_cast<int>(factor.type), type + 6);
    EXPECT_EQ(datum_of(factor), datum);
    EXPECT_FALSE(set_datum(factor, datum)) << "it has one";
    ASSERT_FALSE(find_fault(factor));

    Graph graph;
    std::vector<double> start(value_numbers(info.signature[0]), 0.0);
    if (info.signature[0] == VariableType::kPose3) start[6] = 1.0;
    const std::vector<VariableId> ids{{1}};
    ASSERT_TRUE(add_variable(graph, ids[0], info.signature[0], start));
    const NewFactor described = describe_factor(graph, *add_factor(graph, factor, ids));
    EXPECT_EQ(described.type, plain.type);
    EXPECT_EQ(described.numbers, plain.numbers);

    factor.numbers.end()[-3] = 91.0;
    EXPECT_EQ(find_fault(factor)->reason,
              std::string(info.name) +
                  "_at_datum has a datum that is no latitude, longitude and height (deg, m)");
    factor.numbers.pop_back();
    EXPECT_EQ(find_fault(factor)->code, RefusalCode::kMalformed);
  }
  NewFactor other;
  other.type = FactorType{17};
  EXPECT_FALSE(set_datum(other, datum));
}

}  // namespace
}  // namespace cairn
