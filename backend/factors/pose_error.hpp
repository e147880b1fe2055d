// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/geometry/se2.hpp"
#include "cairn/geometry/se3.hpp"
#include "cairn/graph/factor_batch.hpp"

namespace cairn {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// The error vector of a pose error E (identity when prediction equals measurement), shared by
/// every factor that measures a pose. J_e_right = d e / d delta for E * Exp(delta).
inline Eigen::Vector3d pose_error(const Se2& E, Eigen::Matrix3d* J_e_right) {
  if (J_e_right) {
    *J_e_right << E.rotation().cos(), -E.rotation().sin(), 0.0,  //
        E.rotation().sin(), E.rotation().cos(), 0.0,             //
        0.0, 0.0, 1.0;
  }
  return E.to_vector();
}

/// As above in space. kG2o: (t, 2 x imaginary part of the quaternion with w >= 0); kLog and kGtsam:
/// Log(E).
inline Vector6d pose_error(const Se3& E, ErrorChart chart, Matrix6d* J_e_right) {
  Vector6d e;
  if (chart != ErrorChart::kG2o) {
    e = E.log();
    if (J_e_right) *J_e_right = Se3::right_jacobian_inverse(e);
    return e;
  }
  const Eigen::Quaterniond& q = E.rotation().quaternion();
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  e.head<3>() = E.translation();
  e.tail<3>() = 2.0 * sign * q.vec();
  if (J_e_right) {  // q * Exp(d): d vec = (w I + [vec]x) d / 2
    J_e_right->setZero();
    J_e_right->topLeftCorner<3, 3>() = E.rotation().matrix();
    J_e_right->bottomRightCorner<3, 3>() =
        sign * (q.w() * Eigen::Matrix3d::Identity() + skew(q.vec()));
  }
  return e;
}

/// Information as the chart weighs it. GTSAM takes a file's SE(3) numbers without the rescaling to
/// radians (rotation block x4, mixed block x2).
inline Matrix6d pose_information(const Matrix6d& information, ErrorChart chart) {
  if (chart != ErrorChart::kGtsam) return information;
  Matrix6d scaled = information;
  scaled.topRightCorner<3, 3>() *= 2.0;
  scaled.bottomLeftCorner<3, 3>() *= 2.0;
  scaled.bottomRightCorner<3, 3>() *= 4.0;
  return scaled;
}

/// Isotropic weights of a pose information, for initialization: 2 / tr(Omega_t^-1) and Omega_r in
/// the plane, 3 / tr(Omega_t^-1) and 3 / tr(Omega_r^-1) in space (the exact covariance blocks are
/// not needed for a start).
struct IsotropicWeights {
  double translation;  ///< 1/m^2
  double rotation;     ///< 1/rad^2
};
IsotropicWeights isotropic_weights(const Eigen::Matrix3d& information);
IsotropicWeights isotropic_weights(const Matrix6d& information);

}  // namespace cairn
