// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <sstream>
#include <string>

#include "cairn/graph/typed_batch.hpp"
#include "tests/support/random.hpp"

namespace cairn::test {

struct JacobianCheck {
  int samples = 1000;
  std::uint64_t seed = 20260701;
  /// In the tangent space. Fourth-order differences, so truncation is of order step^4; a tenth of
  /// it is tried where that is too much (close to a singularity the derivatives grow without
  /// bound).
  double step = 5e-4;
  double tolerance = 1e-8;  ///< on |J - numeric| / max(1, |J|), over all coefficients
};

/// The derivative of one factor's whitened residual by its k-th variable, by central differences of
/// fourth order. Empty when the residual jumps within a step: an angle at its cut has no
/// derivative.
inline Eigen::MatrixXd numeric_jacobian(const FactorBatch& batch, std::size_t factor, std::size_t k,
                                        Values values, ErrorChart chart, double step) {
  const std::size_t arity = batch.signature().size();
  const VariableType type = batch.signature()[k];
  const std::uint32_t index = batch.variable_indices()[factor * arity + k];
  const int dimension = tangent_dimension(type);
  const Values start = values;
  const auto residual_at = [&](int axis, double delta) -> Eigen::VectorXd {
    values = start;
    Eigen::VectorXd tangent = Eigen::VectorXd::Zero(dimension);
    tangent[axis] = delta;
    values.retract(type, index, tangent.data());
    return batch.evaluate(factor, {values, chart}).residual;
  };
  Eigen::MatrixXd J(batch.residual_dimension(), dimension);
  for (int axis = 0; axis < dimension; ++axis) {
    const Eigen::VectorXd near = residual_at(axis, step) - residual_at(axis, -step);
    const Eigen::VectorXd far = residual_at(axis, 2.0 * step) - residual_at(axis, -2.0 * step);
    if (near.lpNorm<Eigen::Infinity>() > 0.5 || far.lpNorm<Eigen::Infinity>() > 0.5) return {};
    J.col(axis) = (8.0 * near - far) / (12.0 * step);
  }
  return J;
}

/// The worst disagreement seen so far, and where.
struct JacobianGap {
  double worst = 0.0;
  int skipped = 0;  ///< Jacobians at a cut
  std::string where;

  /// Compares the Jacobian of factor 0 by its k-th variable with differences.
  void compare(const FactorBatch& batch, std::size_t k, const EvaluationContext& context,
               const JacobianCheck& check, const std::string& label) {
    const Eigen::MatrixXd analytic = batch.evaluate(0, context).jacobians[k];
    double gap = 0.0;
    Eigen::MatrixXd numeric;
    for (const double step : {check.step, 0.1 * check.step}) {
      numeric = numeric_jacobian(batch, 0, k, context.values, context.chart, step);
      if (numeric.size() == 0) {
        ++skipped;
        return;
      }
      const double scale = std::max(1.0, numeric.cwiseAbs().maxCoeff());
      gap = analytic.allFinite() ? (analytic - numeric).cwiseAbs().maxCoeff() / scale
                                 : std::numeric_limits<double>::infinity();
      if (gap <= check.tolerance) break;
    }
    if (gap <= worst) return;
    worst = gap;
    std::ostringstream text;
    text << label << ", chart " << static_cast<int>(context.chart) << ", variable " << k
         << "\nanalytic\n"
         << analytic << "\nnumeric\n"
         << numeric;
    where = text.str();
  }
};

/// Checks the analytic Jacobians of factor type F against differences, at random values, hence at
/// large residuals, in all error charts. `make_factor(Random&)` draws a factor; give it a full
/// information matrix. The message names seed, sample, chart and the worst gap.
template <class F, class MakeFactor>
testing::AssertionResult jacobians_match_differences(MakeFactor make_factor,
                                                     JacobianCheck check = {}) {
  Random random(check.seed);
  JacobianGap gap;
  for (int sample = 0; sample < check.samples; ++sample) {
    Values values;
    std::array<std::uint32_t, F::Variables::kArity> indices;
    for (std::size_t k = 0; k < indices.size(); ++k) {
      indices[k] = append_random_variable(F::Variables::kArray[k], random, values);
    }
    TypedBatch<F> batch;
    batch.add(make_factor(random), indices, FactorKind::kOther);
    for (const ErrorChart chart : {ErrorChart::kG2o, ErrorChart::kLog, ErrorChart::kGtsam}) {
      for (std::size_t k = 0; k < indices.size(); ++k) {
        gap.compare(batch, k, {values, chart}, check, "sample " + std::to_string(sample));
      }
    }
  }
  const bool good = gap.worst <= check.tolerance && gap.skipped <= check.samples / 10;
  return (good ? testing::AssertionSuccess() : testing::AssertionFailure())
         << F::kName << ": worst gap " << gap.worst << " (tolerance " << check.tolerance
         << ", seed " << check.seed << ", " << gap.skipped << " Jacobians skipped at a cut) at "
         << gap.where;
}

}  // namespace cairn::test
