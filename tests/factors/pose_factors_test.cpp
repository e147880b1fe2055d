// SPDX-License-Identifier: BSD-3-Clause
#include "tests/factors/random_factors.hpp"
#include "tests/support/factor_checks.hpp"

namespace cairn::test {
namespace {

template <class F>
class PoseFactors : public testing::Test {};
using PoseFactorTypes = testing::Types<PriorSe2, PriorSe3, PriorXy, BetweenSe2, BetweenSe3,
                                       BetweenOffsetSe2, BetweenOffsetSe3>;
TYPED_TEST_SUITE(PoseFactors, PoseFactorTypes);

TYPED_TEST(PoseFactors, JacobiansMatchDifferencesFarFromZeroResidual) {
  EXPECT_TRUE((jacobians_match_differences<TypeParam>(random_factor<TypeParam>)));
}

TYPED_TEST(PoseFactors, AllWaysToAskForTheCostAgree) {
  expect_costs_agree<TypeParam>(random_factor<TypeParam>);
}

TYPED_TEST(PoseFactors, LinearizeMatchesDenseAssemblyWithEveryLoss) {
  expect_linearize_matches_dense_assembly<TypeParam>(random_factor<TypeParam>);
}

TYPED_TEST(PoseFactors, SkipNullJacobians) {
  expect_null_jacobians_are_skipped<TypeParam>(random_factor<TypeParam>);
}

}  // namespace
}  // namespace cairn::test
