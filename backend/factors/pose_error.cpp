// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/factors/pose_error.hpp"

#include <Eigen/LU>

namespace cairn {
namespace {

// n / tr(block^-1); for a singular block the mean of its diagonal serves.
template <int N>
double isotropic_weight(const Eigen::Matrix<double, N, N>& block) {
  const double inverse_trace = block.inverse().trace();
  if (std::isfinite(inverse_trace) && inverse_trace > 0.0) return N / inverse_trace;
  return block.trace() / N;
}

}  // namespace

IsotropicWeights isotropic_weights(const Eigen::Matrix3d& information) {
  return {isotropic_weight<2>(information.topLeftCorner<2, 2>()), information(2, 2)};
}

IsotropicWeights isotropic_weights(const Matrix6d& information) {
  return {isotropic_weight<3>(information.topLeftCorner<3, 3>()),
          isotropic_weight<3>(information.bottomRightCorner<3, 3>())};
}

}  // namespace cairn
