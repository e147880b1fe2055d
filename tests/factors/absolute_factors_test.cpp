// SPDX-License-Identifier: BSD-3-Clause
#include "tests/factors/random_factors.hpp"
#include "tests/support/factor_checks.hpp"

namespace cairn::test {
namespace {

template <class F>
class AbsoluteFactors : public testing::Test {};
using AbsoluteFactorTypes = testing::Types<GnssSe2, GnssSe3, Altitude, YawSe2, YawSe3, Gravity>;
TYPED_TEST_SUITE(AbsoluteFactors, AbsoluteFactorTypes);

TYPED_TEST(AbsoluteFactors, JacobiansMatchDifferencesFarFromZeroResidual) {
  EXPECT_TRUE((jacobians_match_differences<TypeParam>(random_factor<TypeParam>)));
}

TYPED_TEST(AbsoluteFactors, AllWaysToAskForTheCostAgree) {
  expect_costs_agree<TypeParam>(random_factor<TypeParam>);
}

TYPED_TEST(AbsoluteFactors, LinearizeMatchesDenseAssemblyWithEveryLoss) {
  expect_linearize_matches_dense_assembly<TypeParam>(random_factor<TypeParam>);
}

TYPED_TEST(AbsoluteFactors, SkipNullJacobians) {
  expect_null_jacobians_are_skipped<TypeParam>(random_factor<TypeParam>);
}

}  // namespace
}  // namespace cairn::test
