// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace cairn {

/// [v]x: skew(v) * w = v x w.
inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// A rotation in space, as a unit quaternion. Keeps the quaternion it was given unless its norm is
/// off by more than 1e-9 (files are read and written without change). Tangent: rotation vector,
/// rad.
class So3 {
 public:
  using Tangent = Eigen::Vector3d;

  So3() : quaternion_(Eigen::Quaterniond::Identity()) {}
  explicit So3(const Eigen::Quaterniond& q);

  [[nodiscard]] const Eigen::Quaterniond& quaternion() const { return quaternion_; }
  [[nodiscard]] Eigen::Matrix3d matrix() const { return quaternion_.toRotationMatrix(); }
  [[nodiscard]] So3 inverse() const { return unchecked(quaternion_.conjugate()); }
  friend So3 operator*(const So3& a, const So3& b) {
    return unchecked(a.quaternion_ * b.quaternion_);
  }
  friend Eigen::Vector3d operator*(const So3& R, const Eigen::Vector3d& p) {
    return R.quaternion_ * p;
  }

  [[nodiscard]] static So3 exp(const Tangent& delta_rad);
  /// Rotation vector of length in [0, pi].
  [[nodiscard]] Tangent log() const;
  /// The nearest rotation to a matrix in the Frobenius norm.
  [[nodiscard]] static So3 project(const Eigen::Matrix3d& m);
  /// d Log(Exp(v) * Exp(d)) / dd at d = 0.
  [[nodiscard]] static Eigen::Matrix3d right_jacobian_inverse(const Tangent& v);

 private:
  static So3 unchecked(const Eigen::Quaterniond& q) {
    So3 rotation;
    rotation.quaternion_ = q;
    return rotation;
  }

  Eigen::Quaterniond quaternion_;
};

}  // namespace cairn
