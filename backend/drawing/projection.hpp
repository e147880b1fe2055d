// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

namespace cairn::drawing {

/// An orthographic view of the map. Rows of R_view_map: right, up, towards the eye.
struct Projection {
  Eigen::Matrix3d R_view_map = Eigen::Matrix3d::Identity();
  bool has_depth = false;  ///< false where everything lies (nearly) in the plane of the page

  /// Right, up, towards the eye, m.
  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& p_map) const {
    return R_view_map * p_map;
  }
};

/// Flat point sets are seen face on, upright along their closest axes (a drive in a camera frame
/// shows x and z); others obliquely from above, with the longest horizontal extent across the page.
Projection choose_projection(std::span<const Eigen::Vector3d> points);

}  // namespace cairn::drawing
