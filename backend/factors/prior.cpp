// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/factors/prior.hpp"

namespace cairn {

Eigen::Vector3d PriorSe2::error(const Se2& T_map_body, ErrorChart /*chart*/,
                                Eigen::Matrix3d* J_e_pose) const {
  return pose_error(T_map_body_measured.inverse() * T_map_body, J_e_pose);
}

Vector6d PriorSe3::error(const Se3& T_map_body, ErrorChart chart, Matrix6d* J_e_pose) const {
  const Se3 E = T_map_sensor_measured.inverse() * T_map_body * sensor.T_body_sensor;
  Matrix6d J_e_right;
  const Vector6d e = pose_error(E, chart, J_e_pose ? &J_e_right : nullptr);
  // A motion of the body is the adjoint motion of the sensor.
  if (J_e_pose) *J_e_pose = J_e_right * sensor.T_body_sensor.inverse().adjoint();
  return e;
}

Eigen::Vector2d PriorXy::error(const Se2& T_map_body, ErrorChart /*chart*/,
                               Eigen::Matrix<double, 2, 3>* J_e_pose) const {
  if (J_e_pose) *J_e_pose << T_map_body.rotation().matrix(), Eigen::Vector2d::Zero();
  return T_map_body.translation() - p_map_measured;
}

template class TypedBatch<PriorSe2>;
template class TypedBatch<PriorSe3>;
template class TypedBatch<PriorXy>;

}  // namespace cairn
