// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/geometry/information.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace cairn {
namespace {

// For the rare matrix that is not definite; of dynamic size, because that is compiled once.
using EigenSolver = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;

// Whether L D L^T with a positive D exists: elimination without roots, of half the matrix.
template <int N>
bool is_positive_definite(Eigen::Matrix<double, N, N> m) {
  for (int k = 0; k < N; ++k) {
    if (!(m(k, k) > 0.0)) return false;
    const double scale = 1.0 / m(k, k);
    for (int j = k + 1; j < N; ++j) {
      const double factor = m(j, k) * scale;
      for (int i = j; i < N; ++i) m(i, j) -= factor * m(i, k);
    }
  }
  return true;
}

}  // namespace

template <int N>
Eigen::Matrix<double, N, N> sqrt_information(const Eigen::Matrix<double, N, N>& information) {
  const Eigen::LLT<Eigen::Matrix<double, N, N>> llt(information);
  if (llt.info() == Eigen::Success) return llt.matrixU();
  const EigenSolver eigen(information);
  const Eigen::Matrix<double, N, N> V = eigen.eigenvectors();
  const Eigen::Matrix<double, N, 1> roots = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return V * roots.asDiagonal() * V.transpose();
}

template <int N>
bool is_positive_semidefinite(const Eigen::Matrix<double, N, N>& information) {
  if (is_positive_definite<N>(information)) return true;
  const EigenSolver eigen(information, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().minCoeff() >= -1e-9 * eigen.eigenvalues().cwiseAbs().maxCoeff();
}

#define CAIRN_INSTANTIATE(N)                                                                    \
  template Eigen::Matrix<double, N, N> sqrt_information<N>(const Eigen::Matrix<double, N, N>&); \
  template bool is_positive_semidefinite<N>(const Eigen::Matrix<double, N, N>&)
CAIRN_INSTANTIATE(1);
CAIRN_INSTANTIATE(2);
CAIRN_INSTANTIATE(3);
CAIRN_INSTANTIATE(4);
CAIRN_INSTANTIATE(5);
CAIRN_INSTANTIATE(6);
#undef CAIRN_INSTANTIATE

}  // namespace cairn
