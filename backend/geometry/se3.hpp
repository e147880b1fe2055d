// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "cairn/geometry/so3.hpp"

namespace cairn {

/// A rigid motion in space. Tangent order: translation m, rotation rad. Conventions:
/// backend/geometry/README.md.
class Se3 {
 public:
  using Tangent = Eigen::Matrix<double, 6, 1>;

  Se3() = default;
  Se3(const So3& rotation, const Eigen::Vector3d& translation_m)
      : rotation_(rotation), translation_(translation_m) {}

  [[nodiscard]] const So3& rotation() const { return rotation_; }
  [[nodiscard]] const Eigen::Vector3d& translation() const { return translation_; }

  [[nodiscard]] Se3 inverse() const {
    const So3 R_inverse = rotation_.inverse();
    return {R_inverse, -(R_inverse * translation_)};
  }
  friend Se3 operator*(const Se3& T_a_b, const Se3& T_b_c) {
    return {T_a_b.rotation_ * T_b_c.rotation_,
            T_a_b.translation_ + T_a_b.rotation_ * T_b_c.translation_};
  }
  friend Eigen::Vector3d operator*(const Se3& T_a_b, const Eigen::Vector3d& p_b) {
    return T_a_b.rotation_ * p_b + T_a_b.translation_;
  }

  [[nodiscard]] static Se3 exp(const Tangent& delta);
  [[nodiscard]] Tangent log() const;
  /// Maps a right perturbation to the left: T * Exp(d) = Exp(Ad_T * d) * T.
  [[nodiscard]] Eigen::Matrix<double, 6, 6> adjoint() const;
  /// d Log(Exp(v) * Exp(d)) / dd at d = 0. Barfoot 2014, eq. (7.83), with our tangent order.
  [[nodiscard]] static Eigen::Matrix<double, 6, 6> right_jacobian_inverse(const Tangent& v);
  /// T [+] delta = T * Exp(delta), with the quaternion normalized.
  [[nodiscard]] Se3 retract(const Tangent& delta) const {
    const Se3 moved = *this * exp(delta);
    return {So3(moved.rotation_.quaternion().normalized()), moved.translation_};
  }

 private:
  So3 rotation_;
  Eigen::Vector3d translation_ = Eigen::Vector3d::Zero();
};

}  // namespace cairn
