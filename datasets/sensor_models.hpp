// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/factors/altitude.hpp"
#include "cairn/factors/bearing.hpp"
#include "cairn/factors/between_offset.hpp"
#include "cairn/factors/gnss.hpp"
#include "cairn/factors/gravity.hpp"
#include "cairn/factors/landmark_xy.hpp"
#include "cairn/factors/landmark_xyz.hpp"
#include "cairn/factors/prior.hpp"
#include "cairn/factors/range.hpp"
#include "cairn/factors/range_bearing.hpp"
#include "cairn/factors/yaw.hpp"
#include "datasets/noise.hpp"

namespace cairn {

/// Sensors that see the true state and answer with a factor whose error is drawn from its
/// information.
class SensorModels {
 public:
  static constexpr ParameterId kMounting2{0}, kMounting3{1};
  static Se2 mounting2() { return {0.4, -0.1, 0.3}; }  ///< T_body_sensor
  static Se3 mounting3();
  static Eigen::Vector3d antenna() { return {-0.3, 0.2, 1.1}; }  ///< p_body_antenna

  /// `noise` as in SimulationOptions.
  SensorModels(double noise, Random& random)
      : scale_(noise > 0.0 ? noise : 1.0), exact_(noise == 0.0), random_(random) {}

  LandmarkXy landmark_xy(const Se2& T_map_body, const Eigen::Vector2d& p_map);
  BearingXy bearing(const Se2& T_map_body, const Eigen::Vector2d& p_map);
  RangeXy range(const Se2& T_map_body, const Eigen::Vector2d& p_map);
  RangeBearingXy range_bearing(const Se2& T_map_body, const Eigen::Vector2d& p_map);
  GnssSe2 gnss(const Se2& T_map_body);
  YawSe2 yaw(const Se2& T_map_body);
  PriorSe2 prior(const Se2& T_map_body);
  PriorXy position(const Se2& T_map_body);
  BetweenOffsetSe2 between_offset(const Se2& T_map_a, const Se2& T_map_b);

  LandmarkXyz landmark_xyz(const Se3& T_map_body, const Eigen::Vector3d& p_map);
  RangeXyz range(const Se3& T_map_body, const Eigen::Vector3d& p_map);
  RangeBearingXyz range_bearing(const Se3& T_map_body, const Eigen::Vector3d& p_map);
  GnssSe3 gnss(const Se3& T_map_body);
  Altitude altitude(const Se3& T_map_body);
  YawSe3 yaw(const Se3& T_map_body);
  Gravity gravity(const Se3& T_map_body);
  PriorSe3 prior(const Se3& T_map_body);
  BetweenOffsetSe3 between_offset(const Se3& T_map_a, const Se3& T_map_b);

 private:
  template <int N>
  Eigen::Matrix<double, N, 1> error(const Eigen::Matrix<double, N, N>& information) {
    return exact_ ? Eigen::Matrix<double, N, 1>::Zero() : draw_error<N>(information, random_);
  }
  template <int N>
  Eigen::Matrix<double, N, N> information(const Eigen::Matrix<double, N, 1>& sigmas,
                                          double correlation);

  double scale_;
  bool exact_;
  Random& random_;
};

}  // namespace cairn
