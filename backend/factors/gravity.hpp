// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/factors/point_in_body.hpp"
#include "cairn/graph/typed_batch.hpp"

namespace cairn {

/// The direction of gravity (down: -z of the map) in body axes, measured. An accelerometer at rest
/// reads the opposite direction. With g = R_map_body^T * (0, 0, -1) and the unit measurement m,
/// both in body axes,
///   e = B^T g * sqrt(2 / (1 + g.m)),   B = (b1, b2) = gravity_tangent_basis(m),
/// so e is the tilt about m in rad for small tilts, |e| = |g - m| = 2 sin(tilt / 2) for all, and it
/// has no false minimum upside down. Two rows, because a direction has two degrees of freedom:
/// residuals stay chi-square.
struct Gravity {
  static constexpr std::string_view kName = "gravity";
  using Variables = Signature<VariableType::kPose3>;
  static constexpr int kDimension = 2;
  static constexpr bool kAbsolute = true;

  Eigen::Vector3d down_body_measured;  ///< need not be normalized, must not be zero
  Eigen::Matrix2d information;         ///< rad, along b1 and b2

  Eigen::Vector2d error(const Se3& T_map_body, ErrorChart chart, Jacobian<2, 6>* J_e_pose) const;
};

extern template class TypedBatch<Gravity>;

/// Two unit vectors orthogonal to the unit vector m and to each other: b1 is the body's x axis made
/// orthogonal to m (its y axis where |m.x| > 0.9), b2 = m x b1. For a level body (m = -z): b1 = x,
/// b2 = -y.
Jacobian<3, 2> gravity_tangent_basis(const Eigen::Vector3d& m);

}  // namespace cairn
