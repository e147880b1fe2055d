// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/factors/bearing.hpp"

#include "cairn/factors/polar.hpp"

namespace cairn {

Scalar1d BearingXy::error(const Se2& T_map_body, const Eigen::Vector2d& p_map, ErrorChart /*chart*/,
                          Jacobian<1, 3>* J_e_pose, Jacobian<1, 2>* J_e_point) const {
  Jacobian<2, 3> J_p_pose;
  Jacobian<2, 2> J_p_point;
  const Eigen::Vector2d p_body = point_in_body(T_map_body, p_map, &J_p_pose, &J_p_point);
  Eigen::RowVector2d J_bearing_p;
  const double bearing = bearing_of(p_body.x(), p_body.y(), &J_bearing_p);
  if (J_e_pose) *J_e_pose = J_bearing_p * J_p_pose;
  if (J_e_point) *J_e_point = J_bearing_p * J_p_point;
  return Scalar1d(wrap_angle(bearing - bearing_rad_measured));
}

template class TypedBatch<BearingXy>;

}  // namespace cairn
