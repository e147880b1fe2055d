// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/geometry/se2.hpp"

#include <cmath>

namespace cairn {
namespace {

// sin(t)/t and (1 - cos(t))/t; series below 5e-3, where the next term is under 1e-17.
struct VCoefficients {
  double a, b;
};
VCoefficients v_coefficients(double theta) {
  const double t2 = theta * theta;
  if (t2 < 25e-6) {
    return {1.0 - t2 * (1.0 / 6.0 - t2 / 120.0), theta * (0.5 - t2 * (1.0 / 24.0 - t2 / 720.0))};
  }
  const double sin_half = std::sin(0.5 * theta), cos_half = std::cos(0.5 * theta);
  return {2.0 * sin_half * cos_half / theta, 2.0 * sin_half * sin_half / theta};
}

Eigen::Vector2d exp_translation(const Se2::Tangent& delta) {
  const auto [a, b] = v_coefficients(delta.z());
  return {a * delta.x() - b * delta.y(), b * delta.x() + a * delta.y()};
}

}  // namespace

Se2 Se2::exp(const Tangent& delta) { return {So2(delta.z()), exp_translation(delta)}; }

// The angles add up: cosine and sine of delta's own are not needed.
Se2 Se2::retract(const Tangent& delta) const {
  return {So2(theta() + delta.z()), translation_ + rotation_ * exp_translation(delta)};
}

Se2::Tangent Se2::log() const {
  const double theta = rotation_.angle();
  const auto [a, b] = v_coefficients(theta);
  const double scale = 1.0 / (a * a + b * b);  // V^-1 = [a b; -b a] / (a^2 + b^2)
  return {scale * (a * x() + b * y()), scale * (a * y() - b * x()), theta};
}

Eigen::Matrix3d Se2::adjoint() const {
  Eigen::Matrix3d adjoint;
  adjoint << rotation_.cos(), -rotation_.sin(), y(),  //
      rotation_.sin(), rotation_.cos(), -x(),         //
      0.0, 0.0, 1.0;
  return adjoint;
}

}  // namespace cairn
