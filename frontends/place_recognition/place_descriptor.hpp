// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "frontends/matching/scan_points.hpp"

namespace cairn {

/// What surfaces around a place look like, whichever way one looks there: how many cells of 0.2 m
/// at which distance (24 bins of 0.5 m) are seen at which angle from their normal (4 bins, and one
/// of those without a normal). Of unit length, or zero where there are no surfaces.
using PlaceDescriptor = Eigen::Matrix<float, 24 * 5, 1>;

/// Of points (m) around the origin.
PlaceDescriptor describe_place(const std::vector<SurfacePoint>& points);

/// 1: the same; 0: nothing in common.
inline float similarity(const PlaceDescriptor& a, const PlaceDescriptor& b) { return a.dot(b); }

}  // namespace cairn
