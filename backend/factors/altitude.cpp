// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/factors/altitude.hpp"

namespace cairn {

Scalar1d Altitude::error(const Se3& T_map_body, ErrorChart /*chart*/,
                         Jacobian<1, 6>* J_e_pose) const {
  if (J_e_pose) {
    *J_e_pose << T_map_body.rotation().matrix().row(2), Eigen::RowVector3d::Zero();
  }
  return Scalar1d(T_map_body.translation().z() - z_map_m_measured);
}

template class TypedBatch<Altitude>;

}  // namespace cairn
