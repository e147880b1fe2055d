// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "cairn/drawing/canvas.hpp"
#include "cairn/drawing/color_scale.hpp"

namespace cairn::drawing {

/// One entry of the list of line and dot kinds.
struct LegendKey {
  std::string name;
  Color color = kInk;
  bool is_dot = false;
};

/// Writes title and line of numbers at the top of the page.
void draw_heading(Canvas& canvas, const std::string& title, const std::string& numbers);
/// Writes the keys in a row that starts at `position`.
void draw_keys(Canvas& canvas, const Point& position, const std::vector<LegendKey>& keys);
/// Draws the colours with their values; `rect` is the coloured bar, ticks are below and the label
/// above it.
void draw_color_bar(Canvas& canvas, const Rect& rect, const ColorScale& scale,
                    const std::string& label);

}  // namespace cairn::drawing
