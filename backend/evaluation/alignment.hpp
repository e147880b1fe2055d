// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "cairn/geometry/se3.hpp"

namespace cairn {

enum class AlignmentKind {
  kNone,
  kSe3,   ///< rotation and translation
  kSim3,  ///< and scale
  kYaw,   ///< rotation about z and translation
};

/// p_reference = scale * R * p_estimate + t.
struct Alignment {
  So3 R_reference_estimate;
  Eigen::Vector3d t_reference_estimate = Eigen::Vector3d::Zero();
  double scale = 1.0;
  /// False when the positions lie on a line or in a point, so that they do not tell the whole
  /// rotation: of all that fit equally well it is then the smallest.
  bool rotation_determined = true;

  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& p) const {
    return scale * (R_reference_estimate * p) + t_reference_estimate;
  }
  [[nodiscard]] Se3 operator*(const Se3& T) const {
    return {R_reference_estimate * T.rotation(), *this * T.translation()};
  }
};

/// The least-squares fit of the estimated positions to the reference (Umeyama 1991). `planar`: both
/// lie in the xy plane, so the rotation is about z for every kind. The spans are equally long, not
/// empty, and finite.
Alignment align(AlignmentKind kind, std::span<const Se3> reference, std::span<const Se3> estimate,
                bool planar = false);

}  // namespace cairn
