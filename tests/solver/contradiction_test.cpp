// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/contradiction.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cairn/factors/prior.hpp"
#include "tests/solver/small_problems.hpp"

namespace cairn {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

// 21 poses on a straight line, one meter apart. Odometry is known to a centimeter per step; a false
// loop, the last factor, says that the last pose is the first one.
class Line : public testing::Test {
 protected:
  Line() {
    for (std::uint64_t i = 0; i <= 20; ++i)
      EXPECT_TRUE(graph_.add_pose2({i}, Se2(static_cast<double>(i), 0.0, 0.0)));
    for (std::uint64_t i = 0; i < 20; ++i) tie(i, i + 1, 1.0, 1e4, FactorKind::kOdometry);
  }
  void tie(std::uint64_t a, std::uint64_t b, double x, double information, FactorKind kind) {
    BetweenSe2 factor{Se2(x, 0.0, 0.0), information * Eigen::Matrix3d::Identity()};
    EXPECT_TRUE(graph_.add_factor(factor, {VariableId{a}, VariableId{b}}, kind));
  }
  std::optional<Contradiction> find(double x = 0.0) {
    tie(0, 20, x, 1e4, FactorKind::kLoop);
    return find_contradiction(graph_, graph_.factor_count() - 1);
  }

  Graph graph_;
};

TEST_F(Line, OdometryAloneContradictsItWhereNothingElseIsThere) {
  const auto found = find();
  ASSERT_TRUE(found);
  EXPECT_THAT(found->factors, SizeIs(20));
  EXPECT_GT(found->chi2, found->threshold);
  EXPECT_EQ(found->threshold, 102.0);
  // 20 m, of which 21 measurements along the way know 1 cm each.
  EXPECT_NEAR(found->chi2, 400.0 / (21.0 * 1e-4), 1.0);
}

TEST_F(Line, AShortWayThatKnowsEnoughIsTheSmallest) {
  tie(2, 19, 17.0, 1e4, FactorKind::kLoop);  // factor 20
  const auto found = find();
  ASSERT_TRUE(found);
  EXPECT_THAT(found->factors, ElementsAre(0, 1, 20, 19));
}

TEST_F(Line, AShortWayThatKnowsNothingIsNone) {
  tie(2, 19, 17.0, 1e-4, FactorKind::kLoop);
  const auto found = find();
  ASSERT_TRUE(found);
  EXPECT_THAT(found->factors, SizeIs(20));
}

TEST_F(Line, NothingContradictsWhatIsTrue) { EXPECT_FALSE(find(20.0)); }

TEST_F(Line, NothingContradictsWhatIsNoRelativePoseOrTiesWhatNothingElseTies) {
  EXPECT_TRUE(graph_.add_factor(PriorSe2{Se2(), Eigen::Matrix3d::Identity()}, {VariableId{3}}));
  EXPECT_FALSE(find_contradiction(graph_, graph_.factor_count() - 1));
  EXPECT_TRUE(graph_.add_pose2({99}, Se2()));
  tie(0, 99, 5.0, 1e4, FactorKind::kLoop);
  EXPECT_FALSE(find_contradiction(graph_, graph_.factor_count() - 1));
}

TEST_F(Line, EndsWhenItIsTold) {
  tie(0, 20, 0.0, 1e4, FactorKind::kLoop);
  EXPECT_FALSE(find_contradiction(graph_, graph_.factor_count() - 1, [] { return false; }));
}

}  // namespace
}  // namespace cairn
