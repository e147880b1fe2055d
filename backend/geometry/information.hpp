// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace cairn {

/// U with U^T U = Omega, so that |U e|^2 = e^T Omega e. Upper triangular (L^T of Omega = L L^T) for
/// a definite Omega, the symmetric eigenvalue root for a semidefinite one. Omega must be symmetric.
/// Instantiated for N = 1 to 6.
template <int N>
Eigen::Matrix<double, N, N> sqrt_information(const Eigen::Matrix<double, N, N>& information);

/// True when Omega is positive semidefinite up to rounding: smallest eigenvalue >= -1e-9 * largest
/// magnitude.
template <int N>
bool is_positive_semidefinite(const Eigen::Matrix<double, N, N>& information);

/// Diagonal information 1/sigma^2.
template <int N>
Eigen::Matrix<double, N, N> information_from_sigmas(const Eigen::Matrix<double, N, 1>& sigmas) {
  return sigmas.cwiseAbs2().cwiseInverse().asDiagonal();
}

}  // namespace cairn
