// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/factors/between_offset.hpp"

namespace cairn {

Eigen::Vector3d BetweenOffsetSe2::error(const Se2& T_map_a, const Se2& T_map_b,
                                        ErrorChart /*chart*/, Eigen::Matrix3d* J_e_a,
                                        Eigen::Matrix3d* J_e_b) const {
  const Se2 T_a_sensor_b = T_map_a.inverse() * T_map_b * sensor_b.T_body_sensor;
  const Se2 E =
      T_sensor_a_sensor_b_measured.inverse() * sensor_a.T_body_sensor.inverse() * T_a_sensor_b;
  Eigen::Matrix3d J_e_right;
  const Eigen::Vector3d e = pose_error(E, J_e_a || J_e_b ? &J_e_right : nullptr);
  if (J_e_a) *J_e_a = -J_e_right * T_a_sensor_b.inverse().adjoint();
  if (J_e_b) *J_e_b = J_e_right * sensor_b.T_body_sensor.inverse().adjoint();
  return e;
}

RelativePose<Se2> BetweenOffsetSe2::relative_pose(std::uint32_t a, std::uint32_t b) const {
  const IsotropicWeights weights = isotropic_weights(information);
  const Se2 T_a_b =
      sensor_a.T_body_sensor * T_sensor_a_sensor_b_measured * sensor_b.T_body_sensor.inverse();
  return {a, b, T_a_b, weights.translation, weights.rotation};
}

Vector6d BetweenOffsetSe3::error(const Se3& T_map_a, const Se3& T_map_b, ErrorChart chart,
                                 Matrix6d* J_e_a, Matrix6d* J_e_b) const {
  const Se3 T_a_sensor_b = T_map_a.inverse() * T_map_b * sensor_b.T_body_sensor;
  const Se3 E =
      T_sensor_a_sensor_b_measured.inverse() * sensor_a.T_body_sensor.inverse() * T_a_sensor_b;
  Matrix6d J_e_right;
  const Vector6d e = pose_error(E, chart, J_e_a || J_e_b ? &J_e_right : nullptr);
  if (J_e_a) *J_e_a = -J_e_right * T_a_sensor_b.inverse().adjoint();
  if (J_e_b) *J_e_b = J_e_right * sensor_b.T_body_sensor.inverse().adjoint();
  return e;
}

RelativePose<Se3> BetweenOffsetSe3::relative_pose(std::uint32_t a, std::uint32_t b) const {
  const IsotropicWeights weights = isotropic_weights(information);
  const Se3 T_a_b =
      sensor_a.T_body_sensor * T_sensor_a_sensor_b_measured * sensor_b.T_body_sensor.inverse();
  return {a, b, T_a_b, weights.translation, weights.rotation};
}

template class TypedBatch<BetweenOffsetSe2>;
template class TypedBatch<BetweenOffsetSe3>;

}  // namespace cairn
