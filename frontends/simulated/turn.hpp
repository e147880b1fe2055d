// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

namespace cairn {

/// (cos, sin) of an angle by additions and multiplications alone, which are the same on every
/// machine; libm's are not in the last bit. Good to 1e-15 for angles of a few turns.
inline Eigen::Vector2d heading(double angle_rad) {
  const double quarter = std::nearbyint(angle_rad * (2.0 / std::numbers::pi));
  const double x = angle_rad - quarter * (0.5 * std::numbers::pi), xx = x * x;
  double c = 1.0, s = 1.0;  // Taylor, from the small terms on: |x| <= pi / 4
  for (int n = 18; n >= 2; n -= 2) {
    c = 1.0 - xx / (n * (n - 1)) * c;
    s = 1.0 - xx / (n * (n + 1)) * s;
  }
  s *= x;
  switch (static_cast<int>(quarter) & 3) {
    case 0:
      return {c, s};
    case 1:
      return {-s, c};
    case 2:
      return {-c, -s};
    default:
      return {s, -c};
  }
}

}  // namespace cairn
