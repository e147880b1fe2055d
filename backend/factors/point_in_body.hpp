// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/geometry/se2.hpp"
#include "cairn/geometry/se3.hpp"

namespace cairn {

/// What each factor type repeats about shapes: Jacobian<rows, columns>.
template <int kRows, int kColumns>
using Jacobian = Eigen::Matrix<double, kRows, kColumns>;

/// 1 x 1, for scalar measurements.
using Scalar1d = Eigen::Matrix<double, 1, 1>;

/// p_body = T_map_body^-1 * p_map: how a body sees a point, shared by every factor that observes a
/// landmark. With T * Exp(d) the point moves by -(d_t + d_r x p_body); with p_map + d by R^T d.
/// Null Jacobians are skipped.
inline Eigen::Vector2d point_in_body(const Se2& T_map_body, const Eigen::Vector2d& p_map,
                                     Jacobian<2, 3>* J_p_pose, Jacobian<2, 2>* J_p_point) {
  const So2 R_body_map = T_map_body.rotation().inverse();
  const Eigen::Vector2d p_body = R_body_map * (p_map - T_map_body.translation());
  if (J_p_pose) *J_p_pose << -1.0, 0.0, p_body.y(), 0.0, -1.0, -p_body.x();
  if (J_p_point) *J_p_point = R_body_map.matrix();
  return p_body;
}

inline Eigen::Vector3d point_in_body(const Se3& T_map_body, const Eigen::Vector3d& p_map,
                                     Jacobian<3, 6>* J_p_pose, Jacobian<3, 3>* J_p_point) {
  const Eigen::Matrix3d R_body_map = T_map_body.rotation().inverse().matrix();
  const Eigen::Vector3d p_body = R_body_map * (p_map - T_map_body.translation());
  if (J_p_pose) *J_p_pose << -Eigen::Matrix3d::Identity(), skew(p_body);
  if (J_p_point) *J_p_point = R_body_map;
  return p_body;
}

}  // namespace cairn
