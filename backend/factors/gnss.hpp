// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/factors/point_in_body.hpp"
#include "cairn/graph/typed_batch.hpp"

namespace cairn {

/// The position of an antenna in the map; the antenna sits at p_body_antenna on the body (the lever
/// arm). e = T_map_body * p_body_antenna - p_map_antenna_measured, m.
struct GnssSe2 {
  static constexpr std::string_view kName = "gnss_se2";
  using Variables = Signature<VariableType::kPose2>;
  static constexpr int kDimension = 2;
  static constexpr bool kAbsolute = true;

  Eigen::Vector2d p_body_antenna;
  Eigen::Vector2d p_map_antenna_measured;
  Eigen::Matrix2d information;  ///< m, in map axes

  Eigen::Vector2d error(const Se2& T_map_body, ErrorChart chart, Jacobian<2, 3>* J_e_pose) const;
};

/// As above in space.
struct GnssSe3 {
  static constexpr std::string_view kName = "gnss_se3";
  using Variables = Signature<VariableType::kPose3>;
  static constexpr int kDimension = 3;
  static constexpr bool kAbsolute = true;

  Eigen::Vector3d p_body_antenna;
  Eigen::Vector3d p_map_antenna_measured;
  Eigen::Matrix3d information;  ///< m, in map axes

  Eigen::Vector3d error(const Se3& T_map_body, ErrorChart chart, Jacobian<3, 6>* J_e_pose) const;
};

extern template class TypedBatch<GnssSe2>;
extern template class TypedBatch<GnssSe3>;

}  // namespace cairn
