// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/factors/pose_error.hpp"
#include "cairn/factors/sensor_offset.hpp"
#include "cairn/graph/typed_batch.hpp"

namespace cairn {

/// The pose itself, measured. e = vec(T_measured^-1 * T_map_body), vec = (x m, y m, theta rad).
struct PriorSe2 {
  static constexpr std::string_view kName = "prior_se2";
  using Variables = Signature<VariableType::kPose2>;
  static constexpr int kDimension = 3;
  static constexpr bool kAbsolute = true;

  Se2 T_map_body_measured;
  Eigen::Matrix3d information;  ///< m, rad

  Eigen::Vector3d error(const Se2& T_map_body, ErrorChart chart, Eigen::Matrix3d* J_e_pose) const;
};

/// The pose of a sensor on the body, measured. e = chart(T_measured^-1 * T_map_body *
/// T_body_sensor): translation m, then rotation as the error chart says (rad).
struct PriorSe3 {
  static constexpr std::string_view kName = "prior_se3";
  using Variables = Signature<VariableType::kPose3>;
  static constexpr int kDimension = 6;
  static constexpr bool kAbsolute = true;

  Se3 T_map_sensor_measured;
  SensorOffset<Se3> sensor;
  Matrix6d information;  ///< m, rad

  Vector6d error(const Se3& T_map_body, ErrorChart chart, Matrix6d* J_e_pose) const;
  [[nodiscard]] Matrix6d information_in(ErrorChart chart) const {
    return pose_information(information, chart);
  }
};

/// The position of a planar pose, measured in the map. e = t_map_body - p_measured, m.
struct PriorXy {
  static constexpr std::string_view kName = "prior_xy";
  using Variables = Signature<VariableType::kPose2>;
  static constexpr int kDimension = 2;
  static constexpr bool kAbsolute = true;

  Eigen::Vector2d p_map_measured;
  Eigen::Matrix2d information;  ///< m

  Eigen::Vector2d error(const Se2& T_map_body, ErrorChart chart,
                        Eigen::Matrix<double, 2, 3>* J_e_pose) const;
};

extern template class TypedBatch<PriorSe2>;
extern template class TypedBatch<PriorSe3>;
extern template class TypedBatch<PriorXy>;

}  // namespace cairn
