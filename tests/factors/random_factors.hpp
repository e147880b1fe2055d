// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>

#include "cairn/factors/altitude.hpp"
#include "cairn/factors/bearing.hpp"
#include "cairn/factors/between.hpp"
#include "cairn/factors/between_offset.hpp"
#include "cairn/factors/gnss.hpp"
#include "cairn/factors/gravity.hpp"
#include "cairn/factors/landmark_xy.hpp"
#include "cairn/factors/landmark_xyz.hpp"
#include "cairn/factors/prior.hpp"
#include "cairn/factors/range.hpp"
#include "cairn/factors/range_bearing.hpp"
#include "cairn/factors/yaw.hpp"
#include "tests/support/random.hpp"

namespace cairn::test {

inline SensorOffset<Se2> random_sensor2(Random& random) {
  return {random.pose2(1.0), ParameterId{3}};
}
inline SensorOffset<Se3> random_sensor3(Random& random) {
  return {random.pose3(1.0), ParameterId{4}};
}

/// A factor of type F with a random measurement and a full random information matrix.
template <class F>
F random_factor(Random& random) {
  F f;
  const auto is = [&]<class... Candidates>() { return (std::same_as<F, Candidates> || ...); };
  if constexpr (is.template operator()<BetweenSe2>()) f.T_a_b_measured = random.pose2();
  if constexpr (is.template operator()<BetweenSe3>()) f.T_a_b_measured = random.pose3();
  if constexpr (is.template operator()<PriorSe2>()) f.T_map_body_measured = random.pose2();
  if constexpr (is.template operator()<PriorXy>()) f.p_map_measured = random.vector<2>(10.0);
  if constexpr (is.template operator()<PriorSe3>()) {
    f.T_map_sensor_measured = random.pose3();
    f.sensor = random_sensor3(random);
  }
  if constexpr (is.template operator()<BetweenOffsetSe2>()) {
    f.T_sensor_a_sensor_b_measured = random.pose2();
    f.sensor_a = random_sensor2(random);
    f.sensor_b = random_sensor2(random);
  }
  if constexpr (is.template operator()<BetweenOffsetSe3>()) {
    f.T_sensor_a_sensor_b_measured = random.pose3();
    f.sensor_a = random_sensor3(random);
    f.sensor_b = random_sensor3(random);
  }
  if constexpr (is.template operator()<LandmarkXy>()) {
    f.p_sensor_measured = random.vector<2>(10.0);
    f.sensor = random_sensor2(random);
  }
  if constexpr (is.template operator()<LandmarkXyz>()) {
    f.p_sensor_measured = random.vector<3>(10.0);
    f.sensor = random_sensor3(random);
  }
  if constexpr (is.template operator()<RangeXy, RangeXyz, RangeBearingXy, RangeBearingXyz>()) {
    f.range_m_measured = random.uniform(0.5, 20.0);
  }
  if constexpr (is.template operator()<BearingXy, RangeBearingXy>())
    f.bearing_rad_measured = random.angle();
  if constexpr (is.template operator()<RangeBearingXyz>()) {
    f.azimuth_rad_measured = random.angle();
    f.elevation_rad_measured = 0.5 * random.angle();
  }
  if constexpr (is.template operator()<GnssSe2>()) {
    f.p_body_antenna = random.vector<2>();
    f.p_map_antenna_measured = random.vector<2>(10.0);
  }
  if constexpr (is.template operator()<GnssSe3>()) {
    f.p_body_antenna = random.vector<3>();
    f.p_map_antenna_measured = random.vector<3>(10.0);
  }
  if constexpr (is.template operator()<Altitude>()) f.z_map_m_measured = random.normal();
  if constexpr (is.template operator()<YawSe2, YawSe3>()) f.yaw_rad_measured = random.angle();
  if constexpr (is.template operator()<Gravity>()) f.down_body_measured = random.vector<3>();
  f.information = random.information<F::kDimension>();
  return f;
}

}  // namespace cairn::test
