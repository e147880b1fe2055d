// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/factors/point_in_body.hpp"
#include "cairn/factors/sensor_offset.hpp"
#include "cairn/graph/typed_batch.hpp"

namespace cairn {

/// The position of a planar landmark in the frame of a sensor. e = (T_map_body * T_body_sensor)^-1
/// * p_map - p_measured, m.
struct LandmarkXy {
  static constexpr std::string_view kName = "landmark_xy";
  using Variables = Signature<VariableType::kPose2, VariableType::kPoint2>;
  static constexpr int kDimension = 2;
  static constexpr bool kAbsolute = false;

  Eigen::Vector2d p_sensor_measured;
  SensorOffset<Se2> sensor;
  Eigen::Matrix2d information;  ///< m

  Eigen::Vector2d error(const Se2& T_map_body, const Eigen::Vector2d& p_map, ErrorChart chart,
                        Jacobian<2, 3>* J_e_pose, Jacobian<2, 2>* J_e_point) const;
  bool predict_last(const Se2& T_map_body, Eigen::Vector2d& p_map) const;
};

extern template class TypedBatch<LandmarkXy>;

}  // namespace cairn
