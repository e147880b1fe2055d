// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "cairn/drawing/color.hpp"

namespace cairn::drawing {

/// Which value has which colour of the ramp. Values outside [low, high] get the colour of that end.
struct ColorScale {
  static constexpr int kBins = 24;

  double low = 0.0, high = 1.0;
  bool logarithmic = false;
  bool clipped = false;  ///< values above `high` exist

  /// Position in [0, 1].
  [[nodiscard]] double position(double value) const;
  [[nodiscard]] int bin(double value) const;
  [[nodiscard]] static Color bin_color(int bin);
  [[nodiscard]] std::vector<double> ticks() const;
};

/// A scale with round ends over all but the largest 0.5 % of the values (not negative): linear from
/// 0, or logarithmic where a few values dwarf the others.
ColorScale choose_color_scale(std::vector<double> values);

}  // namespace cairn::drawing
