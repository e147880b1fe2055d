// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <cmath>

#include "cairn/linear/linear_solver.hpp"

namespace cairn {
namespace {

// Conjugate gradients with block-Jacobi preconditioning (Saad 2003, algorithm 9.1).
class PcgSolver final : public LinearSolver {
 public:
  void analyze(const BlockPattern& pattern, const Elimination& /*elimination*/) override {
    pattern_ = &pattern;
    inverse_diagonal_.resize(pattern.size());
  }

  bool factorize(const double* values) override {
    values_ = values;
    for (int j = 0; j < pattern_->size(); ++j) {
      const int d = pattern_->dimension[j];
      const Eigen::LLT<Eigen::MatrixXd> llt(Eigen::MatrixXd(panel(j).topRows(d)));
      if (llt.info() != Eigen::Success) return false;
      inverse_diagonal_[j] = llt.solve(Eigen::MatrixXd::Identity(d, d));
    }
    return true;
  }

  void solve(const double* b, double* x) override {
    const int n = pattern_->scalar_size();
    Eigen::VectorXd r = Eigen::Map<const Eigen::VectorXd>(b, n);
    Eigen::VectorXd solution = Eigen::VectorXd::Zero(n);
    const double target = kRelativeTolerance * r.norm();
    Eigen::VectorXd z = precondition(r), p = z;
    double rz = r.dot(z);
    for (int iteration = 0; iteration < kMaxIterations && r.norm() > target; ++iteration) {
      const Eigen::VectorXd Ap = multiply_by(p);
      const double alpha = rz / p.dot(Ap);
      if (!std::isfinite(alpha)) break;
      solution += alpha * p;
      r -= alpha * Ap;
      z = precondition(r);
      const double rz_next = r.dot(z);
      p = z + rz_next / rz * p;
      rz = rz_next;
    }
    Eigen::Map<Eigen::VectorXd>(x, n) = solution;
  }

 private:
  // An inexact step costs outer iterations, not accuracy; a long chain needs thousands of inner
  // ones.
  static constexpr double kRelativeTolerance = 1e-8;
  static constexpr int kMaxIterations = 20000;

  [[nodiscard]] Eigen::Map<const Eigen::MatrixXd> panel(int j) const {
    return {values_ + pattern_->value_begin[j], pattern_->height[j], pattern_->dimension[j]};
  }

  [[nodiscard]] Eigen::VectorXd precondition(const Eigen::VectorXd& r) const {
    Eigen::VectorXd z(r.size());
    for (int j = 0; j < pattern_->size(); ++j) {
      const int first = pattern_->scalar_begin[j], d = pattern_->dimension[j];
      z.segment(first, d).noalias() = inverse_diagonal_[j] * r.segment(first, d);
    }
    return z;
  }

  [[nodiscard]] Eigen::VectorXd multiply_by(const Eigen::VectorXd& p) const {
    Eigen::VectorXd y(p.size());
    multiply(*pattern_, values_, p.data(), y.data());
    return y;
  }

  const BlockPattern* pattern_ = nullptr;
  const double* values_ = nullptr;
  std::vector<Eigen::MatrixXd> inverse_diagonal_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_pcg_solver() { return std::make_unique<PcgSolver>(); }

}  // namespace cairn
