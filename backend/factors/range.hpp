// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/factors/point_in_body.hpp"
#include "cairn/graph/typed_batch.hpp"

namespace cairn {

/// The distance of a planar landmark from the body. e = |p_body| - range, m.
struct RangeXy {
  static constexpr std::string_view kName = "range_xy";
  using Variables = Signature<VariableType::kPose2, VariableType::kPoint2>;
  static constexpr int kDimension = 1;
  static constexpr bool kAbsolute = false;

  double range_m_measured;
  Scalar1d information;  ///< 1/m^2

  Scalar1d error(const Se2& T_map_body, const Eigen::Vector2d& p_map, ErrorChart chart,
                 Jacobian<1, 3>* J_e_pose, Jacobian<1, 2>* J_e_point) const;
};

/// The distance of a landmark from the body. e = |p_body| - range, m.
struct RangeXyz {
  static constexpr std::string_view kName = "range_xyz";
  using Variables = Signature<VariableType::kPose3, VariableType::kPoint3>;
  static constexpr int kDimension = 1;
  static constexpr bool kAbsolute = false;

  double range_m_measured;
  Scalar1d information;  ///< 1/m^2

  Scalar1d error(const Se3& T_map_body, const Eigen::Vector3d& p_map, ErrorChart chart,
                 Jacobian<1, 6>* J_e_pose, Jacobian<1, 3>* J_e_point) const;
};

extern template class TypedBatch<RangeXy>;
extern template class TypedBatch<RangeXyz>;

}  // namespace cairn
