// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/factors/yaw.hpp"

#include "cairn/factors/polar.hpp"

namespace cairn {

Scalar1d YawSe2::error(const Se2& T_map_body, ErrorChart /*chart*/,
                       Jacobian<1, 3>* J_e_pose) const {
  if (J_e_pose) *J_e_pose << 0.0, 0.0, 1.0;
  return Scalar1d(wrap_angle(T_map_body.theta() - yaw_rad_measured));
}

Scalar1d YawSe3::error(const Se3& T_map_body, ErrorChart /*chart*/,
                       Jacobian<1, 6>* J_e_pose) const {
  const Eigen::Matrix3d R = T_map_body.rotation().matrix();
  Eigen::RowVector2d J_yaw_x;
  const double yaw = bearing_of(R(0, 0), R(1, 0), &J_yaw_x);
  if (J_e_pose) {  // R * Exp(d) moves the x axis by R * (d x e_x) = R * (0, d_z, -d_y)
    const auto R_top = R.topRows<2>();
    *J_e_pose << 0.0, 0.0, 0.0, 0.0, -J_yaw_x.dot(R_top.col(2)), J_yaw_x.dot(R_top.col(1));
  }
  return Scalar1d(wrap_angle(yaw - yaw_rad_measured));
}

template class TypedBatch<YawSe2>;
template class TypedBatch<YawSe3>;

}  // namespace cairn
