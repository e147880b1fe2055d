// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

namespace cairn {

/// The same angle in (-pi, pi].
inline double wrap_angle(double angle_rad) {
  constexpr double kPi = std::numbers::pi;
  if (angle_rad > -kPi && angle_rad <= kPi) return angle_rad;
  // Sums of two or three wrapped angles need one turn only; the subtraction is exact there.
  const double wrapped = std::abs(angle_rad) <= 3.0 * kPi
                             ? angle_rad - std::copysign(2.0 * kPi, angle_rad)
                             : std::remainder(angle_rad, 2.0 * kPi);
  return wrapped <= -kPi ? kPi : wrapped;
}

/// A planar rotation. Keeps the angle (so that what was read is what is written) beside its cosine
/// and sine (so that edges, which read each pose many times, need no trigonometry).
class So2 {
 public:
  So2() = default;
  explicit So2(double angle_rad)
      : angle_rad_(wrap_angle(angle_rad)), cos_(std::cos(angle_rad_)), sin_(std::sin(angle_rad_)) {}

  [[nodiscard]] double angle() const { return angle_rad_; }  ///< rad, (-pi, pi]
  [[nodiscard]] double cos() const { return cos_; }
  [[nodiscard]] double sin() const { return sin_; }
  [[nodiscard]] Eigen::Matrix2d matrix() const {
    Eigen::Matrix2d R;
    R << cos_, -sin_, sin_, cos_;
    return R;
  }

  [[nodiscard]] So2 inverse() const {
    return So2(angle_rad_ == std::numbers::pi ? angle_rad_ : -angle_rad_, cos_, -sin_);
  }
  /// Exact to rounding; repeated products should go through So2(angle) now and then, as retraction
  /// does.
  friend So2 operator*(const So2& a, const So2& b) {
    return So2(wrap_angle(a.angle_rad_ + b.angle_rad_), a.cos_ * b.cos_ - a.sin_ * b.sin_,
               a.sin_ * b.cos_ + a.cos_ * b.sin_);
  }
  friend Eigen::Vector2d operator*(const So2& R, const Eigen::Vector2d& p) {
    return {R.cos_ * p.x() - R.sin_ * p.y(), R.sin_ * p.x() + R.cos_ * p.y()};
  }

 private:
  So2(double angle_rad, double cos, double sin) : angle_rad_(angle_rad), cos_(cos), sin_(sin) {}

  double angle_rad_ = 0.0;
  double cos_ = 1.0;
  double sin_ = 0.0;
};

}  // namespace cairn
