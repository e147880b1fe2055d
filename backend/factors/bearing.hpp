// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/factors/point_in_body.hpp"
#include "cairn/graph/typed_batch.hpp"

namespace cairn {

/// The direction of a planar landmark from the body, counter-clockwise from its x axis.
/// e = wrap(atan2(p_body.y, p_body.x) - bearing), rad.
struct BearingXy {
  static constexpr std::string_view kName = "bearing_xy";
  using Variables = Signature<VariableType::kPose2, VariableType::kPoint2>;
  static constexpr int kDimension = 1;
  static constexpr bool kAbsolute = false;

  double bearing_rad_measured;
  Scalar1d information;  ///< 1/rad^2

  Scalar1d error(const Se2& T_map_body, const Eigen::Vector2d& p_map, ErrorChart chart,
                 Jacobian<1, 3>* J_e_pose, Jacobian<1, 2>* J_e_point) const;
};

extern template class TypedBatch<BearingXy>;

}  // namespace cairn
