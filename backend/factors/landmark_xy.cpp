// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/factors/landmark_xy.hpp"

namespace cairn {

Eigen::Vector2d LandmarkXy::error(const Se2& T_map_body, const Eigen::Vector2d& p_map,
                                  ErrorChart /*chart*/, Jacobian<2, 3>* J_e_pose,
                                  Jacobian<2, 2>* J_e_point) const {
  const Eigen::Vector2d p_body = point_in_body(T_map_body, p_map, J_e_pose, J_e_point);
  const Se2 T_sensor_body = sensor.T_body_sensor.inverse();
  const Eigen::Matrix2d R_sensor_body = T_sensor_body.rotation().matrix();
  if (J_e_pose) *J_e_pose = R_sensor_body * *J_e_pose;
  if (J_e_point) *J_e_point = R_sensor_body * *J_e_point;
  return T_sensor_body * p_body - p_sensor_measured;
}

bool LandmarkXy::predict_last(const Se2& T_map_body, Eigen::Vector2d& p_map) const {
  p_map = T_map_body * (sensor.T_body_sensor * p_sensor_measured);
  return true;
}

template class TypedBatch<LandmarkXy>;

}  // namespace cairn
