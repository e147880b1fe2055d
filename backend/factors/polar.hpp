// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace cairn {

/// Below this distance a direction says nothing: angles have derivative zero there, and the range
/// grows along x.
inline constexpr double kMinRange_m = 1e-9;

/// |p| and its derivative, a unit vector: along x at the origin, so that the factor can push the
/// point away.
template <int kDim>
double range_of(const Eigen::Matrix<double, kDim, 1>& p,
                Eigen::Matrix<double, 1, kDim>* J_range_p) {
  const double range = p.norm();
  if (J_range_p) {
    if (range < kMinRange_m) {
      *J_range_p = Eigen::Matrix<double, 1, kDim>::Unit(0);
    } else {
      *J_range_p = p.transpose() / range;
    }
  }
  return range;
}

/// atan2(y, x) and its derivative, zero at the origin.
inline double bearing_of(double x, double y, Eigen::RowVector2d* J_bearing_xy) {
  if (J_bearing_xy) {
    const double range2 = x * x + y * y;
    if (range2 < kMinRange_m * kMinRange_m) {
      J_bearing_xy->setZero();
    } else {
      *J_bearing_xy << -y / range2, x / range2;
    }
  }
  return std::atan2(y, x);
}

}  // namespace cairn
