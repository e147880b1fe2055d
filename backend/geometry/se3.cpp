// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/geometry/se3.hpp"

#include <cmath>

namespace cairn {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

// Left Jacobian of SO(3): I + b [w]x + c [w]x^2.
Eigen::Matrix3d so3_left_jacobian(const Eigen::Vector3d& w) {
  const double t2 = w.squaredNorm();
  const double t = std::sqrt(t2);
  const Eigen::Matrix3d W = skew(w);
  if (t < 1e-2) {
    const double b = 0.5 - t2 / 24.0 + t2 * t2 / 720.0;
    const double c = 1.0 / 6.0 - t2 / 120.0 + t2 * t2 / 5040.0;
    return Eigen::Matrix3d::Identity() + b * W + c * W * W;
  }
  const double sin_half = std::sin(0.5 * t);
  return Eigen::Matrix3d::Identity() + 2.0 * sin_half * sin_half / t2 * W +
         (t - std::sin(t)) / (t2 * t) * W * W;
}

// The block that couples translation and rotation in the left Jacobian of SE(3): Barfoot 2014, eq.
// (7.86).
Eigen::Matrix3d coupling_block(const Eigen::Vector3d& v, const Eigen::Vector3d& w) {
  const double t2 = w.squaredNorm();
  const double t = std::sqrt(t2);
  double a, b, c;
  if (t < 5e-2) {  // each coefficient cancels to t^-5; the series leaves errors below 1e-15 here
    a = 1.0 / 6.0 - t2 / 120.0 + t2 * t2 / 5040.0 - t2 * t2 * t2 / 362880.0;
    b = 1.0 / 24.0 - t2 / 720.0 + t2 * t2 / 40320.0 - t2 * t2 * t2 / 3628800.0;
    c = 1.0 / 120.0 - t2 / 2520.0 + t2 * t2 / 120960.0 - t2 * t2 * t2 / 9979200.0;
  } else {
    const double s = std::sin(t), k = std::cos(t);
    a = (t - s) / (t2 * t);
    b = (t2 + 2.0 * k - 2.0) / (2.0 * t2 * t2);
    c = (2.0 * t - 3.0 * s + t * k) / (2.0 * t2 * t2 * t);
  }
  const Eigen::Matrix3d V = skew(v), W = skew(w);
  return 0.5 * V + a * (W * V + V * W + W * V * W) + b * (W * W * V + V * W * W - 3.0 * W * V * W) +
         c * (W * V * W * W + W * W * V * W);
}

}  // namespace

Se3 Se3::exp(const Tangent& delta) {
  const Eigen::Vector3d w = delta.tail<3>();
  return {So3::exp(w), so3_left_jacobian(w) * delta.head<3>()};
}

Se3::Tangent Se3::log() const {
  const Eigen::Vector3d w = rotation_.log();
  Tangent v;
  v.head<3>() =
      So3::right_jacobian_inverse(-w) * translation_;  // left inverse at w = right inverse at -w
  v.tail<3>() = w;
  return v;
}

Matrix6d Se3::adjoint() const {
  const Eigen::Matrix3d R = rotation_.matrix();
  Matrix6d adjoint;
  adjoint << R, skew(translation_) * R, Eigen::Matrix3d::Zero(), R;
  return adjoint;
}

Matrix6d Se3::right_jacobian_inverse(const Tangent& v) {
  // Right Jacobian at v is the left Jacobian at -v.
  const Eigen::Vector3d t = -v.head<3>(), w = -v.tail<3>();
  const Eigen::Matrix3d J_inverse = So3::right_jacobian_inverse(-w);
  Matrix6d result;
  result << J_inverse, -J_inverse * coupling_block(t, w) * J_inverse, Eigen::Matrix3d::Zero(),
      J_inverse;
  return result;
}

}  // namespace cairn
