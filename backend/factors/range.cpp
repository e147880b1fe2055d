// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/factors/range.hpp"

#include "cairn/factors/polar.hpp"

namespace cairn {

Scalar1d RangeXy::error(const Se2& T_map_body, const Eigen::Vector2d& p_map, ErrorChart /*chart*/,
                        Jacobian<1, 3>* J_e_pose, Jacobian<1, 2>* J_e_point) const {
  Jacobian<2, 3> J_p_pose;
  Jacobian<2, 2> J_p_point;
  const Eigen::Vector2d p_body = point_in_body(T_map_body, p_map, &J_p_pose, &J_p_point);
  Eigen::RowVector2d J_range_p;
  const double range = range_of<2>(p_body, &J_range_p);
  if (J_e_pose) *J_e_pose = J_range_p * J_p_pose;
  if (J_e_point) *J_e_point = J_range_p * J_p_point;
  return Scalar1d(range - range_m_measured);
}

Scalar1d RangeXyz::error(const Se3& T_map_body, const Eigen::Vector3d& p_map, ErrorChart /*chart*/,
                         Jacobian<1, 6>* J_e_pose, Jacobian<1, 3>* J_e_point) const {
  Jacobian<3, 6> J_p_pose;
  Jacobian<3, 3> J_p_point;
  const Eigen::Vector3d p_body = point_in_body(T_map_body, p_map, &J_p_pose, &J_p_point);
  Eigen::RowVector3d J_range_p;
  const double range = range_of<3>(p_body, &J_range_p);
  if (J_e_pose) *J_e_pose = J_range_p * J_p_pose;
  if (J_e_point) *J_e_point = J_range_p * J_p_point;
  return Scalar1d(range - range_m_measured);
}

template class TypedBatch<RangeXy>;
template class TypedBatch<RangeXyz>;

}  // namespace cairn
