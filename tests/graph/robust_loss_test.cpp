// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/graph/robust_loss.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace cairn::test {
namespace {

using Kind = RobustLoss::Kind;
constexpr Kind kKinds[] = {Kind::kNone,         Kind::kHuber, Kind::kCauchy,
                           Kind::kGemanMcClure, Kind::kTukey, Kind::kDcs};

class RobustLosses : public testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(All, RobustLosses, testing::ValuesIn(kKinds));

TEST_P(RobustLosses, StartLikeLeastSquares) {
  const RobustLoss loss(GetParam(), 1.7);
  EXPECT_EQ(loss.evaluate(0.0).rho, 0.0);
  EXPECT_EQ(loss.evaluate(0.0).weight, 1.0);
}

TEST_P(RobustLosses, WeightIsTheDerivativeOfRho) {
  for (const double width : {0.5, 1.0, 4.685}) {
    const RobustLoss loss(GetParam(), width);
    for (const double ratio :
         {0.01, 0.3, 0.99, 1.01, 2.0, 50.0}) {  // the kinks at s = width^2 are stepped over
      const double s = ratio * width * width, h = 1e-5 * s;
      const double slope = (loss.evaluate(s + h).rho - loss.evaluate(s - h).rho) / (2.0 * h);
      EXPECT_NEAR(loss.evaluate(s).weight, slope, 1e-8) << "width " << width << ", s " << s;
    }
  }
}

TEST_P(RobustLosses, NeverExceedLeastSquaresAndNeverFall) {
  const RobustLoss loss(GetParam(), 1.3);
  double before = 0.0;
  for (double s = 0.0; s < 30.0; s += 0.01) {
    const RobustLoss::Value value = loss.evaluate(s);
    EXPECT_LE(value.rho, s * (1.0 + 1e-15));
    EXPECT_GE(value.rho, before - 1e-12);
    EXPECT_GE(value.weight, 0.0);
    EXPECT_LE(value.weight, 1.0);
    before = value.rho;
  }
}

TEST_P(RobustLosses, AreContinuousAtTheirWidth) {
  const RobustLoss loss(GetParam(), 2.0);
  const RobustLoss::Value below = loss.evaluate(4.0 * (1.0 - 1e-12)),
                          above = loss.evaluate(4.0 * (1.0 + 1e-12));
  EXPECT_NEAR(below.rho, above.rho, 1e-10);
  EXPECT_NEAR(below.weight, above.weight, 1e-10);
}

TEST_P(RobustLosses, StayFiniteForHugeErrors) {
  const RobustLoss::Value value = RobustLoss(GetParam(), 1.0).evaluate(1e200);
  EXPECT_TRUE(std::isfinite(value.rho));
  EXPECT_TRUE(std::isfinite(value.weight));
}

TEST(RobustLoss, BoundedLossesReachTheirLimits) {
  const double c2 = 2.5 * 2.5;
  EXPECT_NEAR(RobustLoss(Kind::kGemanMcClure, 2.5).evaluate(1e12).rho, c2, 1e-9);
  EXPECT_NEAR(RobustLoss(Kind::kTukey, 2.5).evaluate(1e12).rho, c2 / 3.0, 1e-12);
  EXPECT_NEAR(RobustLoss(Kind::kDcs, 2.5).evaluate(1e12).rho, 3.0 * c2, 1e-9);
}

TEST(RobustLoss, ParsesNamesWithTheirDefaultWidths) {
  EXPECT_EQ(RobustLoss::parse("none").value().kind(), Kind::kNone);
  EXPECT_EQ(RobustLoss::parse("huber").value().width(), 1.345);
  EXPECT_EQ(RobustLoss::parse("cauchy").value().width(), 1.0);
  EXPECT_EQ(RobustLoss::parse("geman-mcclure").value().width(), 1.0);
  EXPECT_EQ(RobustLoss::parse("dcs").value().width(), 1.0);
  EXPECT_EQ(RobustLoss::parse("tukey").value().width(), 4.685);
  const RobustLoss wide = RobustLoss::parse("cauchy:2.5").value();
  EXPECT_EQ(wide.kind(), Kind::kCauchy);
  EXPECT_EQ(wide.width(), 2.5);
}

TEST(RobustLoss, RefusesUnknownNamesAndWidths) {
  EXPECT_EQ(RobustLoss::parse("hubert").error().message,
            "unknown loss 'hubert'; choose none, huber, cauchy, geman-mcclure, tukey or dcs");
  for (const char* text :
       {"huber:", "huber:0", "huber:-1", "huber:nan", "huber:inf", "huber:1x", "huber:1e999"}) {
    EXPECT_EQ(RobustLoss::parse(text).error().code, ErrorCode::kUsage) << text;
  }
}

}  // namespace
}  // namespace cairn::test
