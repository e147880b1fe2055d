// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/drawing/canvas.hpp"
#include "cairn/drawing/color_scale.hpp"
#include "cairn/drawing/trajectory_picture.hpp"

namespace cairn::drawing {

/// Draws the error over the path length into `rect` (the plot area; labels are outside) and their
/// rmse.
void draw_error_chart(Canvas& canvas, const Rect& rect, const TrajectoryErrors& errors,
                      const ColorScale& scale);

}  // namespace cairn::drawing
