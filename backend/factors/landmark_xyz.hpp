// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/factors/point_in_body.hpp"
#include "cairn/factors/sensor_offset.hpp"
#include "cairn/graph/typed_batch.hpp"

namespace cairn {

/// The position of a landmark in the frame of a sensor. e = (T_map_body * T_body_sensor)^-1 * p_map
/// - p_measured, m.
struct LandmarkXyz {
  static constexpr std::string_view kName = "landmark_xyz";
  using Variables = Signature<VariableType::kPose3, VariableType::kPoint3>;
  static constexpr int kDimension = 3;
  static constexpr bool kAbsolute = false;

  Eigen::Vector3d p_sensor_measured;
  SensorOffset<Se3> sensor;
  Eigen::Matrix3d information;  ///< m

  Eigen::Vector3d error(const Se3& T_map_body, const Eigen::Vector3d& p_map, ErrorChart chart,
                        Jacobian<3, 6>* J_e_pose, Jacobian<3, 3>* J_e_point) const;
  bool predict_last(const Se3& T_map_body, Eigen::Vector3d& p_map) const;
};

extern template class TypedBatch<LandmarkXyz>;

}  // namespace cairn
