// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/factors/gravity.hpp"

#include <Eigen/Geometry>

namespace cairn {

Jacobian<3, 2> gravity_tangent_basis(const Eigen::Vector3d& m) {
  const Eigen::Vector3d axis = Eigen::Vector3d::Unit(std::abs(m.x()) > 0.9 ? 1 : 0);
  const Eigen::Vector3d b1 = (axis - m.dot(axis) * m).normalized();
  Jacobian<3, 2> B;
  B << b1, m.cross(b1);
  return B;
}

Eigen::Vector2d Gravity::error(const Se3& T_map_body, ErrorChart /*chart*/,
                               Jacobian<2, 6>* J_e_pose) const {
  const Eigen::Vector3d m = down_body_measured.normalized();
  const Eigen::Vector3d g = T_map_body.rotation().inverse() * Eigen::Vector3d(0.0, 0.0, -1.0);
  const Jacobian<3, 2> B = gravity_tangent_basis(m);
  const double c = 0.5 * (g + m).squaredNorm();  // 1 + g.m, without cancellation near upside down
  if (J_e_pose) J_e_pose->setZero();
  if (c < 1e-12) return {2.0, 0.0};  // exactly upside down, no direction is nearer than another
  const double scale = std::sqrt(2.0 / c);
  const Eigen::Vector2d e = scale * (B.transpose() * g);
  if (J_e_pose) {  // d scale / d g = -scale / (2 c) m^T; g moves by g x d
    J_e_pose->rightCols<3>() = (scale * B.transpose() - 0.5 / c * e * m.transpose()) * skew(g);
  }
  return e;
}

template class TypedBatch<Gravity>;

}  // namespace cairn
