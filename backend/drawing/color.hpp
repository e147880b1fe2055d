// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace cairn::drawing {

/// sRGB in [0, 1].
struct Color {
  double red = 0.0, green = 0.0, blue = 0.0, alpha = 1.0;
};

inline constexpr Color kInk{0.13, 0.17, 0.22};       ///< text and single trajectories
inline constexpr Color kQuietInk{0.42, 0.46, 0.51};  ///< secondary text
inline constexpr Color kHairline{0.82, 0.84, 0.87};  ///< frames and grids
inline constexpr Color kTruth{0.62, 0.67, 0.73};     ///< ground truth and reference
inline constexpr Color kLandmark{0.86, 0.55, 0.05};
inline constexpr Color kPaper{1.0, 1.0, 1.0};

/// From a to b; t in [0, 1].
Color mix(const Color& a, const Color& b, double t);
Color with_alpha(Color color, double alpha);

/// A perceptual ramp from calm (0) to alarming (1): lightness falls evenly, so it also reads in
/// grey.
Color ramp_color(double t);

/// Clearly different inks, one per robot; the first is kInk.
Color robot_color(std::size_t robot);

}  // namespace cairn::drawing
