// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/evaluation/association.hpp"

#include <gtest/gtest.h>

namespace cairn {
namespace {

// Poses whose x tells their place in the list.
Trajectory trajectory(TrajectoryFormat format, const std::vector<std::uint64_t>& keys) {
  Trajectory result{.name = "file", .format = format};
  for (std::size_t i = 0; i < keys.size(); ++i) {
    result.poses.push_back({keys[i], Se3(So3(), {static_cast<double>(i), 0.0, 0.0})});
  }
  return result;
}

using Pairs = std::vector<std::pair<int, int>>;

Pairs pairs(const Association& association) {
  Pairs result;
  for (std::size_t i = 0; i < association.reference.size(); ++i) {
    result.emplace_back(association.reference[i].translation().x(),
                        association.estimate[i].translation().x());
  }
  return result;
}

Pairs by_time(const std::vector<std::uint64_t>& reference,
              const std::vector<std::uint64_t>& estimate, std::uint64_t max_difference) {
  const auto result = associate(trajectory(TrajectoryFormat::kTum, reference),
                                trajectory(TrajectoryFormat::kTum, estimate), max_difference);
  EXPECT_TRUE(result);
  return pairs(*result);
}

TEST(Association, TakesTheNearestStamp) {
  EXPECT_EQ(by_time({100, 200, 300}, {96, 205, 290}, 10), (Pairs{{0, 0}, {1, 1}, {2, 2}}));
}

TEST(Association, RespectsTheMaximumDifference) {
  EXPECT_EQ(by_time({100, 200, 300}, {96, 211, 310}, 10), (Pairs{{0, 0}, {2, 2}}));
}

TEST(Association, GivesAReferencePoseToTheNearerOfTwo) {
  EXPECT_EQ(by_time({100, 200}, {97, 101, 104}, 10), (Pairs{{0, 1}}));
}

TEST(Association, OfEquallyNearReferencesTakesTheEarlier) {
  EXPECT_EQ(by_time({100, 110}, {105}, 10), (Pairs{{0, 0}}));
}

TEST(Association, OfRepeatedStampsTakesTheFirst) {
  EXPECT_EQ(by_time({100, 100, 200}, {100, 200, 200}, 0), (Pairs{{0, 0}, {2, 1}}));
}

TEST(Association, SurvivesGapsAndTrajectoriesOutOfOrder) {
  EXPECT_EQ(by_time({500, 100, 200}, {201, 99, 500, 1000}, 5), (Pairs{{1, 1}, {2, 0}, {0, 2}}));
}

TEST(Association, CountsWhatFindsNoPartner) {
  const auto result = associate(trajectory(TrajectoryFormat::kGraph, {1, 5, 7}),
                                trajectory(TrajectoryFormat::kGraph, {5, 6, 7, 9}));
  ASSERT_TRUE(result);
  EXPECT_EQ(pairs(*result), (Pairs{{1, 0}, {2, 2}}));
  EXPECT_EQ(result->unmatched, 2u);
}

TEST(Association, RefusesStampsAgainstLines) {
  const auto result =
      associate(trajectory(TrajectoryFormat::kTum, {1}), trajectory(TrajectoryFormat::kKitti, {0}));
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().to_string(),
            "file: is KITTI (matched by line), but file is TUM (matched by time stamp); give both "
            "in one format");
}

TEST(Association, RefusesTrajectoriesThatHaveNothingInCommon) {
  const auto result = associate(trajectory(TrajectoryFormat::kTum, {1}),
                                trajectory(TrajectoryFormat::kTum, {1'000'000'000}));
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().message.find("within 0.010000 s"), std::string::npos)
      << result.error().message;
}

}  // namespace
}  // namespace cairn
