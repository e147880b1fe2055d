// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/factors/gnss.hpp"

namespace cairn {

Eigen::Vector2d GnssSe2::error(const Se2& T_map_body, ErrorChart /*chart*/,
                               Jacobian<2, 3>* J_e_pose) const {
  if (J_e_pose) {  // a turn d moves the antenna by d * (-y, x) in body axes
    const Eigen::Vector2d turned(-p_body_antenna.y(), p_body_antenna.x());
    *J_e_pose << T_map_body.rotation().matrix(), T_map_body.rotation() * turned;
  }
  return T_map_body * p_body_antenna - p_map_antenna_measured;
}

Eigen::Vector3d GnssSe3::error(const Se3& T_map_body, ErrorChart /*chart*/,
                               Jacobian<3, 6>* J_e_pose) const {
  if (J_e_pose) {
    const Eigen::Matrix3d R_map_body = T_map_body.rotation().matrix();
    *J_e_pose << R_map_body, -R_map_body * skew(p_body_antenna);
  }
  return T_map_body * p_body_antenna - p_map_antenna_measured;
}

template class TypedBatch<GnssSe2>;
template class TypedBatch<GnssSe3>;

}  // namespace cairn
