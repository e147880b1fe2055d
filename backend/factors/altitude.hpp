// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/factors/point_in_body.hpp"
#include "cairn/graph/typed_batch.hpp"

namespace cairn {

/// The height of a body above the map's xy plane (barometer, floor number). e = t_map_body.z -
/// z_measured, m.
struct Altitude {
  static constexpr std::string_view kName = "altitude";
  using Variables = Signature<VariableType::kPose3>;
  static constexpr int kDimension = 1;
  static constexpr bool kAbsolute = true;

  double z_map_m_measured;
  Scalar1d information;  ///< 1/m^2

  Scalar1d error(const Se3& T_map_body, ErrorChart chart, Jacobian<1, 6>* J_e_pose) const;
};

extern template class TypedBatch<Altitude>;

}  // namespace cairn
