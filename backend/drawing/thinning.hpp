// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "cairn/drawing/canvas.hpp"

namespace cairn::drawing {

/// A line on the page with what decides its look and its place in the drawing order.
struct Stroke {
  Segment line;
  float depth = 0.0F;  ///< 0 nearest to the eye, 1 farthest
  int layer = 0;       ///< drawn in ascending order at equal depth
};

/// Joins the steps of a path that are shorter than `step` page units; `strokes` are consecutive.
std::vector<Stroke> joined_steps(const std::vector<Stroke>& strokes, double step);

/// Drops strokes that would cover another one of the same look: both ends within the same `cell`
/// (page units). Where more than `budget` remain the cells grow until they fit, so a million edges
/// become a bounded picture of the same shape. Higher layers stay; the order is kept.
void drop_covered(std::vector<Stroke>& strokes, double cell, std::size_t budget);

}  // namespace cairn::drawing
