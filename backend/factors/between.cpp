// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/factors/between.hpp"

namespace cairn {
Eigen::Vector3d BetweenSe2::error(const Se2& T_map_a, const Se2& T_map_b, ErrorChart /*chart*/,
                                  Eigen::Matrix3d* J_e_a, Eigen::Matrix3d* J_e_b) const {
  const Se2 T_a_b = T_map_a.inverse() * T_map_b;   // prediction
  const Se2 E = T_a_b_measured.inverse() * T_a_b;  // identity when prediction equals measurement
  Eigen::Matrix3d J_e_right;
  const Eigen::Vector3d e = pose_error(E, J_e_a || J_e_b ? &J_e_right : nullptr);
  if (J_e_a)
    *J_e_a =
        -J_e_right * T_a_b.inverse().adjoint();  // Exp(-d) left of T_a_b = Exp(-Ad d) right of it
  if (J_e_b) *J_e_b = J_e_right;
  return e;
}

RelativePose<Se2> BetweenSe2::relative_pose(std::uint32_t a, std::uint32_t b) const {
  const IsotropicWeights weights = isotropic_weights(information);
  return {a, b, T_a_b_measured, weights.translation, weights.rotation};
}

Vector6d BetweenSe3::error(const Se3& T_map_a, const Se3& T_map_b, ErrorChart chart,
                           Matrix6d* J_e_a, Matrix6d* J_e_b) const {
  const Se3 T_a_b = T_map_a.inverse() * T_map_b;
  const Se3 E = T_a_b_measured.inverse() * T_a_b;
  Matrix6d J_e_right;
  const Vector6d e = pose_error(E, chart, J_e_a || J_e_b ? &J_e_right : nullptr);
  if (J_e_a) *J_e_a = -J_e_right * T_a_b.inverse().adjoint();
  if (J_e_b) *J_e_b = J_e_right;
  return e;
}

RelativePose<Se3> BetweenSe3::relative_pose(std::uint32_t a, std::uint32_t b) const {
  const IsotropicWeights weights = isotropic_weights(information);
  return {a, b, T_a_b_measured, weights.translation, weights.rotation};
}

template class TypedBatch<BetweenSe2>;
template class TypedBatch<BetweenSe3>;

}  // namespace cairn
