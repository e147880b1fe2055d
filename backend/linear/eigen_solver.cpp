// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/SparseCholesky>

#include "cairn/linear/linear_solver.hpp"
#include "cairn/linear/scalar_matrix.hpp"

namespace cairn {
namespace {

class EigenSolver final : public LinearSolver {
 public:
  void analyze(const BlockPattern& pattern, const Elimination& /*elimination*/) override {
    scalar_ = ScalarPattern::lower(pattern);
    size_ = pattern.scalar_size();
    const std::vector<double> zeros(pattern.value_count(), 0.0);
    ldlt_.analyzePattern(view(zeros.data()));
  }

  bool factorize(const double* values) override {
    ldlt_.factorize(view(values));
    factorized_ = ldlt_.info() == Eigen::Success;
    return factorized_ && ldlt_.vectorD().minCoeff() > 0.0;
  }

  void solve(const double* b, double* x) override {
    const Eigen::VectorXd solution = ldlt_.solve(Eigen::Map<const Eigen::VectorXd>(b, size_));
    Eigen::Map<Eigen::VectorXd>(x, size_) = solution;
  }

  [[nodiscard]] std::optional<std::int64_t> factor_nonzeros() const override {
    if (!factorized_) return std::nullopt;
    return static_cast<std::int64_t>(ldlt_.matrixL().nestedExpression().nonZeros()) + size_;
  }

 private:
  using Matrix = Eigen::SparseMatrix<double>;

  [[nodiscard]] Eigen::Map<const Matrix> view(const double* values) const {
    return {size_,
            size_,
            static_cast<Eigen::Index>(scalar_.row.size()),
            scalar_.begin.data(),
            scalar_.row.data(),
            values};
  }

  ScalarPattern scalar_;
  int size_ = 0;
  bool factorized_ = false;
  Eigen::SimplicialLDLT<Matrix, Eigen::Lower, Eigen::NaturalOrdering<int>> ldlt_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_eigen_solver() { return std::make_unique<EigenSolver>(); }

}  // namespace cairn
