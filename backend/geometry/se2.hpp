// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "cairn/geometry/so2.hpp"

namespace cairn {

/// A planar rigid motion. Tangent order: x m, y m, theta rad. Conventions:
/// backend/geometry/README.md.
class Se2 {
 public:
  using Tangent = Eigen::Vector3d;

  Se2() = default;
  Se2(double x_m, double y_m, double theta_rad) : rotation_(theta_rad), translation_(x_m, y_m) {}
  Se2(const So2& rotation, const Eigen::Vector2d& translation_m)
      : rotation_(rotation), translation_(translation_m) {}

  [[nodiscard]] const So2& rotation() const { return rotation_; }
  [[nodiscard]] const Eigen::Vector2d& translation() const { return translation_; }
  [[nodiscard]] double x() const { return translation_.x(); }
  [[nodiscard]] double y() const { return translation_.y(); }
  [[nodiscard]] double theta() const { return rotation_.angle(); }
  /// (x, y, theta): g2o's SE(2) chart, not the logarithm.
  [[nodiscard]] Tangent to_vector() const { return {x(), y(), theta()}; }

  [[nodiscard]] Se2 inverse() const {
    const So2 R_inverse = rotation_.inverse();
    return {R_inverse, -(R_inverse * translation_)};
  }
  friend Se2 operator*(const Se2& T_a_b, const Se2& T_b_c) {
    return {T_a_b.rotation_ * T_b_c.rotation_,
            T_a_b.translation_ + T_a_b.rotation_ * T_b_c.translation_};
  }
  friend Eigen::Vector2d operator*(const Se2& T_a_b, const Eigen::Vector2d& p_b) {
    return T_a_b.rotation_ * p_b + T_a_b.translation_;
  }

  [[nodiscard]] static Se2 exp(const Tangent& delta);
  [[nodiscard]] Tangent log() const;
  /// Maps a right perturbation to the left: T * Exp(d) = Exp(Ad_T * d) * T.
  [[nodiscard]] Eigen::Matrix3d adjoint() const;
  /// T [+] delta = T * Exp(delta). Renews cosine and sine, so products of it do not drift.
  [[nodiscard]] Se2 retract(const Tangent& delta) const;

 private:
  So2 rotation_;
  Eigen::Vector2d translation_ = Eigen::Vector2d::Zero();
};

}  // namespace cairn
