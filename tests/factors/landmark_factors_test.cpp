// SPDX-License-Identifier: BSD-3-Clause
#include "tests/factors/random_factors.hpp"
#include "tests/support/factor_checks.hpp"

namespace cairn::test {
namespace {

template <class F>
class LandmarkFactors : public testing::Test {};
using LandmarkFactorTypes = testing::Types<LandmarkXy, LandmarkXyz, BearingXy, RangeXy, RangeXyz,
                                           RangeBearingXy, RangeBearingXyz>;
TYPED_TEST_SUITE(LandmarkFactors, LandmarkFactorTypes);

TYPED_TEST(LandmarkFactors, JacobiansMatchDifferencesFarFromZeroResidual) {
  EXPECT_TRUE((jacobians_match_differences<TypeParam>(random_factor<TypeParam>)));
}

TYPED_TEST(LandmarkFactors, AllWaysToAskForTheCostAgree) {
  expect_costs_agree<TypeParam>(random_factor<TypeParam>);
}

TYPED_TEST(LandmarkFactors, LinearizeMatchesDenseAssemblyWithEveryLoss) {
  expect_linearize_matches_dense_assembly<TypeParam>(random_factor<TypeParam>);
}

TYPED_TEST(LandmarkFactors, SkipNullJacobians) {
  expect_null_jacobians_are_skipped<TypeParam>(random_factor<TypeParam>);
}

}  // namespace
}  // namespace cairn::test
