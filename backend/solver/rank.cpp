// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/rank.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>

#include "cairn/linear/linear_solver.hpp"

namespace cairn {
namespace {

// Relative to diag(H). A singular matrix leaves pivots of 1e-16 times the growth of rounding
// errors; the least determined direction of a real graph (the bending of a chain of 1e5 poses)
// stays orders of magnitude above.
constexpr double kZeroPivot = 1e-12;
constexpr double kZeroEnergy = 1e-14;
constexpr double kParticipates = 1e-5;
constexpr int kMaxFreeDirections = 256;

using FreeVariable = RankReport::FreeVariable;

// Eigenvectors of one diagonal block whose eigenvalue vanishes in the block's own scale.
Eigen::MatrixXd local_null_space(const Eigen::MatrixXd& block) {
  const int d = static_cast<int>(block.rows());
  const double largest = block.diagonal().maxCoeff();
  if (!(largest > 0.0)) return Eigen::MatrixXd::Identity(d, d);
  Eigen::VectorXd scale(d);  // a direction without any information keeps its own axis
  for (int k = 0; k < d; ++k) scale[k] = block(k, k) > 0.0 ? 1.0 / std::sqrt(block(k, k)) : 1.0;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * block *
                                                             scale.asDiagonal());
  int free = 0;
  while (free < d && eigen.eigenvalues()[free] < kZeroPivot) ++free;
  const Eigen::MatrixXd null = scale.asDiagonal() * eigen.eigenvectors().leftCols(free);
  return free == 0
             ? null
             : Eigen::MatrixXd(null.colPivHouseholderQr().householderQ()).leftCols(free).eval();
}

std::vector<FreeVariable> locally_free(const NormalEquations& equations) {
  const BlockPattern& pattern = equations.pattern();
  std::vector<FreeVariable> free;
  for (int j = 0; j < pattern.size(); ++j) {
    const Eigen::Map<const Eigen::MatrixXd> panel(equations.values() + pattern.value_begin[j],
                                                  pattern.height[j], pattern.dimension[j]);
    const Eigen::MatrixXd null = local_null_space(panel.topRows(pattern.dimension[j]));
    if (null.cols() > 0) free.push_back({equations.layout().slot_of_block[j], null});
  }
  return free;
}

// Null vectors of H as columns. Rows whose pivot vanishes are pinned by adding their diagonal
// entry, until the matrix is regular; then H_pinned x = D_p e_p has the null vector with x_p = 1
// and 0 at the other pinned rows.
class NullSpace {
 public:
  NullSpace(NormalEquations& equations, Kernel kernel)
      : equations_(equations), linear_(make_multifrontal_solver(kernel)) {
    linear_->analyze(equations.pattern(), equations.layout().elimination);
  }

  Eigen::MatrixXd find() {
    equations_.set_damping(0.0);
    values_.assign(equations_.values(), equations_.values() + equations_.pattern().value_count());
    while (pin_zero_pivots()) {
    }
    const Eigen::VectorXd& D = equations_.diagonal();
    Eigen::MatrixXd basis(D.size(), static_cast<Eigen::Index>(pinned_.size()));
    Eigen::VectorXd Hx(D.size());
    Eigen::Index kept = 0;
    for (const int row : pinned_) {
      Eigen::VectorXd x = Eigen::VectorXd::Zero(D.size());
      x[row] = D[row];
      linear_->solve(x.data(), x.data());
      multiply(equations_.pattern(), equations_.values(), x.data(), Hx.data());
      if (x.dot(Hx) < kZeroEnergy * x.cwiseAbs2().dot(D)) basis.col(kept++) = x;
    }
    return basis.leftCols(kept);
  }

 private:
  // True when one more row had to be pinned.
  bool pin_zero_pivots() {
    constexpr double kLift = 1e-13;  // keeps the factorization going over zero pivots
    std::vector<double> lifted = values_;
    const Eigen::VectorXd& D = equations_.diagonal();
    for (int row = 0; row < D.size(); ++row) lifted[diagonal_place(row)] += kLift * D[row];
    if (static_cast<int>(pinned_.size()) >= kMaxFreeDirections ||
        !linear_->factorize(lifted.data())) {
      return false;
    }
    const SupernodalFactor factor = *linear_->factor();
    for (int k = 0; k < factor.supernodes(); ++k) {
      for (int c = 0; c < factor.columns(k); ++c) {
        const int row = factor.super[k] + c;
        const double pivot = factor.diagonal(k, c) * factor.diagonal(k, c);
        if (pivot > 100.0 * kZeroPivot * D[row]) continue;
        pinned_.push_back(
            row);  // one at a time: rounding after a zero pivot makes others look like zero
        values_[diagonal_place(row)] += D[row];
        return true;
      }
    }
    return false;
  }

  [[nodiscard]] std::size_t diagonal_place(int row) const {
    const BlockPattern& pattern = equations_.pattern();
    const int j = static_cast<int>(std::upper_bound(pattern.scalar_begin.begin(),
                                                    pattern.scalar_begin.end(), row) -
                                   pattern.scalar_begin.begin()) -
                  1;
    const int k = row - pattern.scalar_begin[j];
    return pattern.value_begin[j] +
           static_cast<std::size_t>(k) * static_cast<std::size_t>(pattern.height[j] + 1);
  }

  NormalEquations& equations_;
  std::unique_ptr<LinearSolver> linear_;
  std::vector<double> values_;
  std::vector<int> pinned_;
};

// The part of a null space that moves one variable.
Eigen::MatrixXd directions_of(const Eigen::MatrixXd& rows) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rows, Eigen::ComputeThinU);
  int rank = 0;
  while (rank < svd.singularValues().size() &&
         svd.singularValues()[rank] > kParticipates * svd.singularValues()[0])
    ++rank;
  return svd.matrixU().leftCols(rank);
}

std::vector<FreeVariable> moved_variables(const NormalEquations& equations,
                                          const Eigen::MatrixXd& basis) {
  const BlockPattern& pattern = equations.pattern();
  const Eigen::VectorXd weight = equations.diagonal().cwiseSqrt();
  const Eigen::MatrixXd scaled = weight.asDiagonal() * basis;
  const Eigen::VectorXd largest = scaled.cwiseAbs().colwise().maxCoeff();
  std::vector<FreeVariable> moved;
  for (int j = 0; j < pattern.size(); ++j) {
    const int first = pattern.scalar_begin[j], d = pattern.dimension[j];
    std::vector<Eigen::Index> columns;
    for (Eigen::Index c = 0; c < basis.cols(); ++c) {
      if (scaled.block(first, c, d, 1).cwiseAbs().maxCoeff() > kParticipates * largest[c])
        columns.push_back(c);
    }
    if (columns.empty()) continue;
    Eigen::MatrixXd rows(d, static_cast<Eigen::Index>(columns.size()));
    for (std::size_t c = 0; c < columns.size(); ++c) {
      rows.col(static_cast<Eigen::Index>(c)) = basis.block(first, columns[c], d, 1);
    }
    moved.push_back({equations.layout().slot_of_block[j], directions_of(rows)});
  }
  return moved;
}

}  // namespace

bool looks_singular(const SupernodalFactor& factor, const Eigen::VectorXd& diagonal) {
  for (int k = 0; k < factor.supernodes(); ++k) {
    for (int c = 0; c < factor.columns(k); ++c) {
      const double pivot = factor.diagonal(k, c) * factor.diagonal(k, c);
      if (!(pivot > kZeroPivot * diagonal[factor.super[k] + c])) return true;
    }
  }
  return false;
}

RankReport find_free_directions(NormalEquations& equations, Kernel kernel) {
  equations.set_damping(0.0);
  RankReport report;
  report.undetermined = locally_free(equations);
  if (!report.undetermined.empty() || equations.pattern().size() == 0) return report;
  const Eigen::MatrixXd basis = NullSpace(equations, kernel).find();
  if (basis.cols() == 0) return report;
  std::vector<FreeVariable> moved = moved_variables(equations, basis);
  // A motion of most of the unknowns is a missing gauge, not a fault of single variables.
  if (2 * moved.size() <= static_cast<std::size_t>(equations.pattern().size())) {
    report.undetermined = std::move(moved);
    return report;
  }
  const std::span<const Variable> variables = equations.problem().graph->variables();
  const auto poses_first = [&](const FreeVariable& a, const FreeVariable& b) {
    const Variable& first = variables[a.slot];
    const Variable& second = variables[b.slot];
    return std::pair(!is_pose(first.type), first.id) < std::pair(!is_pose(second.type), second.id);
  };
  report.anchors.push_back(*std::min_element(moved.begin(), moved.end(), poses_first));
  return report;
}

}  // namespace cairn
