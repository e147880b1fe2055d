// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/factors/point_in_body.hpp"
#include "cairn/graph/typed_batch.hpp"

namespace cairn {

/// Distance and direction of a planar landmark from the body.
/// e = (|p_body| - range m, wrap(atan2(y, x) - bearing) rad).
struct RangeBearingXy {
  static constexpr std::string_view kName = "range_bearing_xy";
  using Variables = Signature<VariableType::kPose2, VariableType::kPoint2>;
  static constexpr int kDimension = 2;
  static constexpr bool kAbsolute = false;

  double range_m_measured;
  double bearing_rad_measured;
  Eigen::Matrix2d information;  ///< m, rad

  Eigen::Vector2d error(const Se2& T_map_body, const Eigen::Vector2d& p_map, ErrorChart chart,
                        Jacobian<2, 3>* J_e_pose, Jacobian<2, 2>* J_e_point) const;
  bool predict_last(const Se2& T_map_body, Eigen::Vector2d& p_map) const;
};

/// Distance and direction of a landmark from the body: azimuth atan2(y, x) around z, elevation
/// atan2(z, |xy|) above the xy plane. e = (range m, wrapped azimuth rad, elevation rad), predicted
/// minus measured.
struct RangeBearingXyz {
  static constexpr std::string_view kName = "range_bearing_xyz";
  using Variables = Signature<VariableType::kPose3, VariableType::kPoint3>;
  static constexpr int kDimension = 3;
  static constexpr bool kAbsolute = false;

  double range_m_measured;
  double azimuth_rad_measured;
  double elevation_rad_measured;
  Eigen::Matrix3d information;  ///< m, rad, rad

  Eigen::Vector3d error(const Se3& T_map_body, const Eigen::Vector3d& p_map, ErrorChart chart,
                        Jacobian<3, 6>* J_e_pose, Jacobian<3, 3>* J_e_point) const;
  bool predict_last(const Se3& T_map_body, Eigen::Vector3d& p_map) const;
};

extern template class TypedBatch<RangeBearingXy>;
extern template class TypedBatch<RangeBearingXyz>;

}  // namespace cairn
