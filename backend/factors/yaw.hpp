// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/factors/point_in_body.hpp"
#include "cairn/graph/typed_batch.hpp"

namespace cairn {

/// The heading of a planar body in the map (compass). e = wrap(theta - yaw), rad.
struct YawSe2 {
  static constexpr std::string_view kName = "yaw_se2";
  using Variables = Signature<VariableType::kPose2>;
  static constexpr int kDimension = 1;
  static constexpr bool kAbsolute = true;

  double yaw_rad_measured;
  Scalar1d information;  ///< 1/rad^2

  Scalar1d error(const Se2& T_map_body, ErrorChart chart, Jacobian<1, 3>* J_e_pose) const;
};

/// The heading of a body in space: where its x axis points, seen from above. e = wrap(atan2(R_10,
/// R_00) - yaw), rad. Where the x axis is vertical there is no heading: the derivative is zero.
struct YawSe3 {
  static constexpr std::string_view kName = "yaw_se3";
  using Variables = Signature<VariableType::kPose3>;
  static constexpr int kDimension = 1;
  static constexpr bool kAbsolute = true;

  double yaw_rad_measured;
  Scalar1d information;  ///< 1/rad^2

  Scalar1d error(const Se3& T_map_body, ErrorChart chart, Jacobian<1, 6>* J_e_pose) const;
};

extern template class TypedBatch<YawSe2>;
extern template class TypedBatch<YawSe3>;

}  // namespace cairn
