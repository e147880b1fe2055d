// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/factors/pose_error.hpp"
#include "cairn/factors/sensor_offset.hpp"
#include "cairn/graph/typed_batch.hpp"

namespace cairn {

/// Relative pose between a sensor on a and a sensor on b.
/// e = vec(T_measured^-1 * (T_map_a * T_a_sensor)^-1 * (T_map_b * T_b_sensor)), vec = (x m, y m,
/// theta rad).
struct BetweenOffsetSe2 {
  static constexpr std::string_view kName = "between_offset_se2";
  using Variables = Signature<VariableType::kPose2, VariableType::kPose2>;
  static constexpr int kDimension = 3;
  static constexpr bool kAbsolute = false;

  Se2 T_sensor_a_sensor_b_measured;
  SensorOffset<Se2> sensor_a, sensor_b;
  Eigen::Matrix3d information;  ///< m, rad

  Eigen::Vector3d error(const Se2& T_map_a, const Se2& T_map_b, ErrorChart chart,
                        Eigen::Matrix3d* J_e_a, Eigen::Matrix3d* J_e_b) const;
  /// Between the bodies; the lever arms are not carried into the weights.
  [[nodiscard]] RelativePose<Se2> relative_pose(std::uint32_t a, std::uint32_t b) const;
};

/// As above in space; the rotation part is as the error chart says (rad).
struct BetweenOffsetSe3 {
  static constexpr std::string_view kName = "between_offset_se3";
  using Variables = Signature<VariableType::kPose3, VariableType::kPose3>;
  static constexpr int kDimension = 6;
  static constexpr bool kAbsolute = false;

  Se3 T_sensor_a_sensor_b_measured;
  SensorOffset<Se3> sensor_a, sensor_b;
  Matrix6d information;  ///< m, rad

  Vector6d error(const Se3& T_map_a, const Se3& T_map_b, ErrorChart chart, Matrix6d* J_e_a,
                 Matrix6d* J_e_b) const;
  [[nodiscard]] Matrix6d information_in(ErrorChart chart) const {
    return pose_information(information, chart);
  }
  /// Between the bodies; the lever arms are not carried into the weights.
  [[nodiscard]] RelativePose<Se3> relative_pose(std::uint32_t a, std::uint32_t b) const;
};

extern template class TypedBatch<BetweenOffsetSe2>;
extern template class TypedBatch<BetweenOffsetSe3>;

}  // namespace cairn
