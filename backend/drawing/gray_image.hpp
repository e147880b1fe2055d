// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include "cairn/core/result.hpp"

namespace cairn {

/// Pixels as bytes, 0 black; the upper row first.
struct GrayImage {
  std::size_t width = 0, height = 0;
  std::string levels;

  /// No picture has more pixels along a side.
  static constexpr std::size_t kMaxSide = 32'767;
};

/// An image that lies under a drawing, seen from above.
struct Backdrop {
  GrayImage image;
  Eigen::Vector2d p_map_corner = Eigen::Vector2d::Zero();  ///< the lower left one, m
  double pixel_m = 0.0;                                    ///< side of a pixel
};

/// The bytes of a gray PNG file. kNotUsable where the image has no pixels, or too many along a
/// side.
Result<std::string> encode_png(const GrayImage& image);

}  // namespace cairn
