// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/matrix_matchers.hpp"
#include "tests/support/random.hpp"

namespace cairn::test {

/// The slow, obvious referee of FactorBatch::linearize. Every factor's blocks get places of their
/// own at random, in arrays filled with a mark; some blocks are stored transposed, some have a
/// larger leading dimension, some are skipped. Afterwards each place must hold rho' J^T J and rho'
/// J^T r of evaluate(), and every other number the mark.
class LinearizeReferee {
 public:
  static constexpr double kMark = -7.25e77;

  LinearizeReferee(const FactorBatch& batch, Random& random)
      : batch_(batch), arity_(batch.signature().size()) {
    std::size_t diagonal = 1, blocks = 1;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      for (std::size_t k = 0; k < arity_; ++k) {
        const auto d = static_cast<std::size_t>(tangent_dimension(batch.signature()[k]));
        const bool skip = random.uniform(0.0, 1.0) < 0.2;
        diagonal_offset_.push_back(skip ? NormalEquationTargets::kSkip : diagonal);
        if (!skip) diagonal += d * d + d + random.index(3);
      }
      for (const auto& [k, l] : pairs()) {
        const int rows = dimension(k), cols = dimension(l);
        const bool transposed = random.coin();
        const int leading = (transposed ? cols : rows) + static_cast<int>(random.index(3));
        const bool skip = random.uniform(0.0, 1.0) < 0.2;
        off_diagonal_.push_back(
            {skip ? NormalEquationTargets::kSkip : blocks, leading, transposed});
        if (!skip)
          blocks +=
              static_cast<std::size_t>(leading * (transposed ? rows : cols)) + random.index(3);
      }
    }
    diagonal_.assign(diagonal + 1, kMark);
    blocks_.assign(blocks + 1, kMark);
  }

  /// Linearizes all factors in two ranges and compares everything. `tolerance` is relative to each
  /// block's size.
  void check(const EvaluationContext& context, double tolerance = 1e-12) {
    const std::size_t half = batch_.size() / 2;
    const NormalEquationTargets targets{diagonal_.data(), diagonal_offset_.data(), blocks_.data(),
                                        off_diagonal_.data()};
    const RangeCost first = batch_.linearize(0, half, context, targets);
    const RangeCost second = batch_.linearize(half, batch_.size(), context, targets);
    double chi2 = 0.0, cost = 0.0;
    for (std::size_t i = 0; i < batch_.size(); ++i) check_factor(i, context, tolerance, chi2, cost);
    EXPECT_NEAR(first.chi2 + second.chi2, chi2, tolerance * (1.0 + chi2));
    EXPECT_NEAR(first.cost + second.cost, cost, tolerance * (1.0 + cost));
    expect_marks_untouched(diagonal_);
    expect_marks_untouched(blocks_);
  }

 private:
  [[nodiscard]] int dimension(std::size_t k) const {
    return tangent_dimension(batch_.signature()[k]);
  }
  [[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> pairs() const {
    if (arity_ < 2) return {};
    if (arity_ == 2) return {{0, 1}};
    return {{0, 1}, {0, 2}, {1, 2}};
  }

  // Compares a stored block and puts the mark back, so that what is left over shows stray writes.
  void expect_block(double* stored, int leading, const Eigen::MatrixXd& expected,
                    double tolerance) {
    Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>> block(
        stored, expected.rows(), expected.cols(), Eigen::OuterStride<>(leading));
    EXPECT_THAT(block, is_near(expected, tolerance * (1.0 + expected.cwiseAbs().maxCoeff())));
    block.setConstant(kMark);
  }

  void check_factor(std::size_t i, const EvaluationContext& context, double tolerance, double& chi2,
                    double& cost) {
    SCOPED_TRACE("factor " + std::to_string(i));
    const FactorEvaluation evaluation = batch_.evaluate(i, context);
    const Eigen::VectorXd& r = evaluation.residual;
    const double s = r.squaredNorm();
    const RobustLoss::Value loss =
        context.robust(batch_.kinds()[i]) ? context.loss.evaluate(s) : RobustLoss::Value{s, 1.0};
    chi2 += s;
    cost += 0.5 * loss.rho;
    for (std::size_t k = 0; k < arity_; ++k) {
      const std::size_t offset = diagonal_offset_[i * arity_ + k];
      if (offset == NormalEquationTargets::kSkip) continue;
      const Eigen::MatrixXd& J = evaluation.jacobians[k];
      const int d = dimension(k);
      expect_block(&diagonal_[offset], d, loss.weight * J.transpose() * J, tolerance);
      expect_block(&diagonal_[offset + static_cast<std::size_t>(d * d)], d,
                   loss.weight * J.transpose() * r, tolerance);
    }
    std::size_t p = i * pairs().size();
    for (const auto& [k, l] : pairs()) {
      const auto& target = off_diagonal_[p++];
      if (target.offset == NormalEquationTargets::kSkip) continue;
      const Eigen::MatrixXd H =
          loss.weight * evaluation.jacobians[k].transpose() * evaluation.jacobians[l];
      expect_block(&blocks_[target.offset], target.leading_dimension,
                   target.transposed ? H.transpose() : H, tolerance);
    }
  }

  static void expect_marks_untouched(const std::vector<double>& numbers) {
    for (std::size_t i = 0; i < numbers.size(); ++i)
      EXPECT_EQ(numbers[i], kMark) << "stray write at " << i;
  }

  const FactorBatch& batch_;
  std::size_t arity_;
  std::vector<std::size_t> diagonal_offset_;
  std::vector<NormalEquationTargets::OffDiagonal> off_diagonal_;
  std::vector<double> diagonal_, blocks_;
};

}  // namespace cairn::test
