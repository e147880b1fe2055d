// SPDX-License-Identifier: BSD-3-Clause
// The hand-written kernels work on two factors at a time; nothing of that may show. That they are
// right is tested with all factors (pose_factors_test.cpp), against the generic path.
#include "tests/factors/random_factors.hpp"
#include "tests/support/factor_checks.hpp"

namespace cairn::test {
namespace {

template <class F>
class BetweenKernels : public testing::Test {
 protected:
  static constexpr std::size_t kFactors = 41;
  static constexpr std::size_t kDim = F::kDimension;
  static constexpr std::size_t kDiagonal = kDim * kDim + kDim;

  // All blocks and gradients, linearized in ranges of `step` factors.
  std::vector<double> linearized(std::size_t step, const EvaluationContext& context) {
    std::vector<double> numbers(kFactors * (2 * kDiagonal + kDim * kDim));
    std::vector<std::size_t> diagonal_offset;
    std::vector<NormalEquationTargets::OffDiagonal> off_diagonal;
    for (std::size_t i = 0; i < kFactors; ++i) {
      diagonal_offset.push_back(2 * i * kDiagonal);
      diagonal_offset.push_back((2 * i + 1) * kDiagonal);
      off_diagonal.push_back(
          {2 * kFactors * kDiagonal + i * kDim * kDim, static_cast<int>(kDim), i % 3 == 0});
    }
    const NormalEquationTargets targets{numbers.data(), diagonal_offset.data(), numbers.data(),
                                        off_diagonal.data()};
    chi2_ = 0.0;
    for (std::size_t i = 0; i < kFactors; i += step) {
      chi2_ += input_.batch.linearize(i, std::min(i + step, kFactors), context, targets).chi2;
    }
    return numbers;
  }

  double linearized_chi2(const EvaluationContext& context) {
    linearized(kFactors, context);
    return chi2_;
  }

  double chi2_ = 0.0;
  Random random_{21};
  RandomBatch<F> input_{kFactors, random_, random_factor<F>};
};
using Betweens = testing::Types<BetweenSe2, BetweenSe3>;
TYPED_TEST_SUITE(BetweenKernels, Betweens);

TYPED_TEST(BetweenKernels, GiveTheSameBitsForAnyRange) {
  for (const auto kind : {RobustLoss::Kind::kNone, RobustLoss::Kind::kCauchy}) {
    const EvaluationContext context{this->input_.values, ErrorChart::kG2o, RobustLoss(kind, 3.0),
                                    true};
    const std::vector<double> whole = this->linearized(this->kFactors, context);
    for (const std::size_t step : {1, 2, 3, 7, 8})
      EXPECT_EQ(this->linearized(step, context), whole) << "step " << step;
  }
}

TYPED_TEST(BetweenKernels, EvaluateTheVeryNumberTheyLinearize) {
  const EvaluationContext context{this->input_.values};
  std::vector<double> chi2(this->kFactors);
  this->input_.batch.evaluate_chi2(0, this->kFactors, context, chi2.data());
  double sum = 0.0;
  for (std::size_t i = 0; i < this->kFactors; ++i) {
    double alone = 0.0;
    this->input_.batch.evaluate_chi2(i, i + 1, context, &alone);
    EXPECT_EQ(alone, chi2[i]);
    sum += chi2[i];
  }
  EXPECT_EQ(this->input_.batch.evaluate_cost(0, this->kFactors, context).chi2, sum);
  EXPECT_EQ(this->linearized_chi2(context), sum);
}

TYPED_TEST(BetweenKernels, DoNothingForAnEmptyRange) {
  const EvaluationContext context{this->input_.values};
  EXPECT_EQ(this->input_.batch.linearize(5, 5, context, {}).chi2, 0.0);
  EXPECT_EQ(this->input_.batch.evaluate_cost(5, 5, context).chi2, 0.0);
}

}  // namespace
}  // namespace cairn::test
