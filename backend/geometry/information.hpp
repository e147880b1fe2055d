// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>

namespace cairn {

/// U with U^T U = Omega, so that |U e|^2 = e^T Omega e. Upper triangular (L^T of Omega = L L^T) for a definite
/// Omega, the symmetric eigenvalue root for a semidefinite one. Omega must be symmetric.
template <int N>
Eigen::Matrix<double, N, N> sqrt_information(const Eigen::Matrix<double, N, N>& information) {
  const Eigen::LLT<Eigen::Matrix<double, N, N>> llt(information);
  if (llt.info() == Eigen::Success) return llt.matrixU();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> eigen(information);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

/// True when Omega is positive semidefinite up to rounding: smallest eigenvalue >= -1e-9 * largest magnitude.
template <int N>
bool is_positive_semidefinite(const Eigen::Matrix<double, N, N>& information) {
  if (Eigen::LLT<Eigen::Matrix<double, N, N>>(information).info() == Eigen::Success) return true;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> eigen(information, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().minCoeff() >= -1e-9 * eigen.eigenvalues().cwiseAbs().maxCoeff();
}

/// Diagonal information 1/sigma^2.
template <int N>
Eigen::Matrix<double, N, N> information_from_sigmas(const Eigen::Matrix<double, N, 1>& sigmas) {
  return sigmas.cwiseAbs2().cwiseInverse().asDiagonal();
}

}  // namespace cairn
