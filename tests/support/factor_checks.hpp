// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <tuple>

#include "tests/support/linearize_referee.hpp"
#include "tests/support/numeric_jacobian.hpp"

namespace cairn::test {

/// A batch of factors at random values: input of the checks below.
template <class F>
struct RandomBatch {
  Values values;
  TypedBatch<F> batch;

  template <class MakeFactor>
  RandomBatch(int count, Random& random, MakeFactor make_factor) {
    for (int i = 0; i < count; ++i) {
      std::array<std::uint32_t, F::Variables::kArity> indices;
      for (std::size_t k = 0; k < indices.size(); ++k) {
        indices[k] = append_random_variable(F::Variables::kArray[k], random, values);
      }
      batch.add(make_factor(random), indices,
                random.coin() ? FactorKind::kLoop : FactorKind::kOdometry);
    }
  }
};

/// chi2 = r^T r = e^T Omega e = what evaluate_chi2, evaluate_cost and linearize report, in every
/// chart.
template <class F, class MakeFactor>
void expect_costs_agree(MakeFactor make_factor, std::uint64_t seed = 11) {
  Random random(seed);
  const RandomBatch<F> input(50, random, make_factor);
  for (const ErrorChart chart : {ErrorChart::kG2o, ErrorChart::kLog, ErrorChart::kGtsam}) {
    const EvaluationContext context{input.values, chart};
    std::vector<double> chi2(input.batch.size());
    input.batch.evaluate_chi2(0, chi2.size(), context, chi2.data());
    for (std::size_t i = 0; i < chi2.size(); ++i) {
      const double squared_norm = input.batch.evaluate(i, context).residual.squaredNorm();
      EXPECT_NEAR(chi2[i], squared_norm, 1e-11 * (1.0 + chi2[i])) << F::kName << ", seed " << seed;
      EXPECT_NEAR(input.batch.evaluate_cost(i, i + 1, context).chi2, chi2[i],
                  1e-11 * (1.0 + chi2[i]))
          << F::kName;
      EXPECT_DOUBLE_EQ(2.0 * input.batch.evaluate_cost(i, i + 1, context).cost,
                       input.batch.evaluate_cost(i, i + 1, context).chi2);
    }
  }
}

/// linearize() against the dense assembly of evaluate(), in every chart, without and with each
/// robust loss.
template <class F, class MakeFactor>
void expect_linearize_matches_dense_assembly(MakeFactor make_factor, std::uint64_t seed = 12) {
  Random random(seed);
  const RandomBatch<F> input(40, random, make_factor);
  using Kind = RobustLoss::Kind;
  for (const ErrorChart chart : {ErrorChart::kG2o, ErrorChart::kLog, ErrorChart::kGtsam}) {
    for (const Kind kind : {Kind::kNone, Kind::kHuber, Kind::kCauchy, Kind::kGemanMcClure,
                            Kind::kTukey, Kind::kDcs}) {
      for (const bool loops_only : {false, true}) {
        SCOPED_TRACE(std::string(F::kName) + ", seed " + std::to_string(seed) + ", chart " +
                     std::to_string(static_cast<int>(chart)) + ", loss " +
                     std::to_string(static_cast<int>(kind)));
        // Wide enough that some factors lie below the width and some above.
        LinearizeReferee(input.batch, random)
            .check({input.values, chart, RobustLoss(kind, 10.0), loops_only});
        if (testing::Test::HasFailure()) return;
      }
    }
  }
}

/// Asking for one Jacobian, or for none, changes neither the error nor the Jacobian asked for.
template <class F, class MakeFactor>
void expect_null_jacobians_are_skipped(MakeFactor make_factor, std::uint64_t seed = 13) {
  Random random(seed);
  const RandomBatch<F> input(20, random, make_factor);
  const auto check = [&]<std::size_t... k>(std::size_t i, std::index_sequence<k...>) {
    constexpr std::size_t kArity = sizeof...(k);
    std::tuple<Eigen::Matrix<double, F::kDimension, tangent_dimension(F::Variables::kArray[k])>...>
        all, one;
    const auto call = [&](auto... J) -> Eigen::VectorXd {
      return input.batch.factor(i).error(
          (input.values.*
           VariableTraits<
               F::Variables::kArray[k]>::kArray)[input.batch.variable_indices()[i * kArity + k]]...,
          ErrorChart::kG2o, J...);
    };
    const Eigen::VectorXd e = call(&std::get<k>(all)...);
    for (std::size_t wanted = 0; wanted <= kArity; ++wanted) {  // kArity: none of them
      EXPECT_THAT(call(k == wanted ? &std::get<k>(one) : nullptr...), is_near(e, 0.0)) << F::kName;
      const auto compare = [&](bool was_wanted, const auto& J, const auto& expected) {
        if (was_wanted) {
          EXPECT_THAT(J, is_near(expected, 0.0)) << F::kName;
        }
      };
      (compare(k == wanted, std::get<k>(one), std::get<k>(all)), ...);
    }
  };
  for (std::size_t i = 0; i < input.batch.size(); ++i)
    check(i, std::make_index_sequence<F::Variables::kArity>());
}

/// All of the above and the Jacobians: everything the solver relies on.
template <class F, class MakeFactor>
void expect_factor_is_sound(MakeFactor make_factor) {
  EXPECT_TRUE((jacobians_match_differences<F>(make_factor)));
  expect_costs_agree<F>(make_factor);
  expect_linearize_matches_dense_assembly<F>(make_factor);
  expect_null_jacobians_are_skipped<F>(make_factor);
}

}  // namespace cairn::test
