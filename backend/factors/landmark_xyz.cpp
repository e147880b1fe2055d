// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/factors/landmark_xyz.hpp"

namespace cairn {

Eigen::Vector3d LandmarkXyz::error(const Se3& T_map_body, const Eigen::Vector3d& p_map,
                                   ErrorChart /*chart*/, Jacobian<3, 6>* J_e_pose,
                                   Jacobian<3, 3>* J_e_point) const {
  const Eigen::Vector3d p_body = point_in_body(T_map_body, p_map, J_e_pose, J_e_point);
  const Se3 T_sensor_body = sensor.T_body_sensor.inverse();
  const Eigen::Matrix3d R_sensor_body = T_sensor_body.rotation().matrix();
  if (J_e_pose) *J_e_pose = R_sensor_body * *J_e_pose;
  if (J_e_point) *J_e_point = R_sensor_body * *J_e_point;
  return T_sensor_body * p_body - p_sensor_measured;
}

bool LandmarkXyz::predict_last(const Se3& T_map_body, Eigen::Vector3d& p_map) const {
  p_map = T_map_body * (sensor.T_body_sensor * p_sensor_measured);
  return true;
}

template class TypedBatch<LandmarkXyz>;

}  // namespace cairn
