// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/geometry/so3.hpp"

#include <Eigen/SVD>
#include <cmath>

namespace cairn {

So3::So3(const Eigen::Quaterniond& q) : quaternion_(q) {
  const double norm = q.norm();
  if (std::abs(norm - 1.0) > 1e-9) quaternion_.coeffs() /= norm;
}

So3 So3::exp(const Tangent& delta_rad) {
  const double angle2 = delta_rad.squaredNorm();
  const double angle = std::sqrt(angle2);
  // sin(angle/2)/angle: the series is exact to rounding below 1e-4.
  const double scale = angle < 1e-4 ? 0.5 - angle2 / 48.0 : std::sin(0.5 * angle) / angle;
  Eigen::Quaterniond q;
  q.w() = std::cos(0.5 * angle);
  q.vec() = scale * delta_rad;
  return unchecked(q);
}

So3::Tangent So3::log() const {
  const double sign = quaternion_.w() < 0.0 ? -1.0 : 1.0;
  const double w = sign * quaternion_.w();
  const Eigen::Vector3d v = sign * quaternion_.vec();
  const double n = v.norm();
  // angle/sin(angle/2) = 2 atan2(n, w)/n; for small n: 2/w * (1 - n^2 / (3 w^2)).
  const double scale =
      n < 1e-4 ? 2.0 / w * (1.0 - n * n / (3.0 * w * w)) : 2.0 * std::atan2(n, w) / n;
  return scale * v;
}

So3 So3::project(const Eigen::Matrix3d& m) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) signs.z() = -1.0;
  const Eigen::Matrix3d R = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  return So3(Eigen::Quaterniond(R));
}

Eigen::Matrix3d So3::right_jacobian_inverse(const Tangent& v) {
  const double angle2 = v.squaredNorm();
  const double angle = std::sqrt(angle2);
  const Eigen::Matrix3d V = skew(v);
  // 1/t^2 - (1 + cos t)/(2 t sin t) = (1 - (t/2) cot(t/2)) / t^2; the series is used where it
  // cancels.
  const double c = angle < 1e-2 ? 1.0 / 12.0 + angle2 / 720.0 + angle2 * angle2 / 30240.0
                                : (1.0 - 0.5 * angle / std::tan(0.5 * angle)) / angle2;
  return Eigen::Matrix3d::Identity() + 0.5 * V + c * V * V;
}

}  // namespace cairn
