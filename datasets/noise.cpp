// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/noise.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

namespace cairn {
namespace {

template <int N>
Eigen::Matrix<double, N, N> inverse_of(const Eigen::Matrix<double, N, N>& covariance) {
  const Eigen::Matrix<double, N, N> inverse = covariance.inverse();
  return 0.5 * (inverse + inverse.transpose());
}

}  // namespace

// Covariance A D A^T with A = [R(axis), perp(t) / 2; 0, 1].
Eigen::Matrix3d pose_information(const PoseSigmas& sigmas, const Se2& T_a_b, double axis_rad) {
  const Eigen::Vector2d t_b = T_a_b.rotation().inverse() * T_a_b.translation();
  Eigen::Matrix3d A = Eigen::Matrix3d::Identity();
  A.topLeftCorner<2, 2>() = So2(axis_rad).matrix();
  A.topRightCorner<2, 1>() << -0.5 * t_b.y(), 0.5 * t_b.x();
  const Eigen::Vector3d sigma(sigmas.ahead_m, sigmas.sideways_m, sigmas.yaw_rad);
  const Eigen::Matrix3d root = A * sigma.asDiagonal();
  return inverse_of<3>(root * root.transpose());
}

// As above, with A = [R(axis), -[t]x / 2; 0, I].
Matrix6d pose_information(const PoseSigmas& sigmas, const Se3& T_a_b, double axis_rad) {
  const Eigen::Vector3d t_b = T_a_b.rotation().inverse() * T_a_b.translation();
  Matrix6d A = Matrix6d::Identity();
  A.topLeftCorner<2, 2>() = So2(axis_rad).matrix();
  A.topRightCorner<3, 3>() = -0.5 * skew(t_b);
  Vector6d sigma;
  sigma << sigmas.ahead_m, sigmas.sideways_m, sigmas.vertical_m, sigmas.tilt_rad, sigmas.tilt_rad,
      sigmas.yaw_rad;
  const Matrix6d root = A * sigma.asDiagonal();
  return inverse_of<6>(root * root.transpose());
}

Se2 pose_with_error(const Eigen::Vector3d& e) { return {e.x(), e.y(), e.z()}; }

Se3 pose_with_error(const Vector6d& e) {
  const Eigen::Vector3d v = 0.5 * e.tail<3>();
  const Eigen::Quaterniond q(std::sqrt(1.0 - v.squaredNorm()), v.x(), v.y(), v.z());
  return {So3(q), e.head<3>()};
}

// e = vec(T_measured^-1 * T_a_b), hence T_measured = T_a_b * E^-1.
BetweenSe2 draw_between(const Se2& T_a_b, const Eigen::Matrix3d& information, bool exact,
                        Random& random) {
  if (exact) return {T_a_b, information};
  return {T_a_b * pose_with_error(draw_error<3>(information, random)).inverse(), information};
}

BetweenSe3 draw_between(const Se3& T_a_b, const Matrix6d& information, bool exact, Random& random) {
  if (exact) return {T_a_b, information};
  Vector6d e;
  do {
    e = draw_error<6>(information, random);
  } while (e.tail<3>().squaredNorm() >=
           4.0);  // the chart ends at half a turn; never met with sane noise
  return {T_a_b * pose_with_error(e).inverse(), information};
}

}  // namespace cairn
