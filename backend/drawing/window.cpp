// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "cairn/drawing/panel.hpp"
#include "cairn/drawing/ruler.hpp"

namespace cairn::drawing {

using Eigen::Vector2d;
using Eigen::Vector3d;

Point Window::to_page(const Vector3d& p_map) const {
  const Vector3d p_view = projection * p_map;
  const Vector2d offset = (p_view.head<2>() - center_m) * units_per_m;
  return rect.center() + Point(offset.x(), -offset.y());
}

double Window::depth(const Vector3d& p_map) const {
  if (!projection.has_depth || near_m <= far_m) return 0.0;
  return std::clamp((near_m - (projection * p_map).z()) / (near_m - far_m), 0.0, 1.0);
}

Window fit_window(const std::vector<Vector3d>& points, const Projection& projection,
                  const Rect& rect) {
  constexpr double kMargin = 0.04, kSmallestM = 1.0;
  Vector3d low = projection * points.front(), high = low;
  for (const Vector3d& p_map : points) {
    const Vector3d p_view = projection * p_map;
    low = low.cwiseMin(p_view);
    high = high.cwiseMax(p_view);
  }
  Vector2d extent_m = (high - low).head<2>();
  if (extent_m.maxCoeff() <= 0.0) extent_m.setConstant(kSmallestM);
  const Vector2d room = Vector2d(rect.width, rect.height) * (1 - 2 * kMargin);
  return {.projection = projection,
          .rect = rect,
          .center_m = (low + high).head<2>() / 2,
          .units_per_m = std::min(room.x() / extent_m.x(), room.y() / extent_m.y()),
          .near_m = high.z(),
          .far_m = low.z()};
}

void draw_scale_bar(Canvas& canvas, const Window& window) {
  constexpr double kLongest = 160.0, kInset = 14.0, kTick = 4.0;
  const double length_m = round_down_125(kLongest / window.units_per_m);
  const Point left(window.rect.x + kInset, window.rect.y + window.rect.height - kInset);
  const Point right = left + Point(length_m * window.units_per_m, 0.0);
  const Point up(0.0, -kTick);
  const std::vector<Point> bar{left + up, left, right, right + up};
  canvas.polyline(bar, {.color = kPaper, .width = 5.0});  // a halo, where the map runs underneath
  canvas.polyline(bar, {.color = kInk, .width = 1.6});
  canvas.text((left + right) / 2 + 2.2 * up, format_length(length_m),
              {.size = 14, .align = Align::kCenter});
}

void draw_axes(Canvas& canvas, const Window& window) {
  if (!window.projection.has_depth) return;
  constexpr double kLength = 34.0, kInset = 52.0;
  constexpr const char* kNames[] = {"x", "y", "z"};
  const Point origin(window.rect.x + window.rect.width - kInset,
                     window.rect.y + window.rect.height - kInset);
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d in_view = window.projection * Vector3d::Unit(axis);
    const Point tip = Point(in_view.x(), -in_view.y()) * kLength;
    canvas.polyline(std::vector<Point>{origin, origin + tip}, {.color = kQuietInk, .width = 1.4});
    canvas.text(origin + 1.25 * tip + Point(0, 5), kNames[axis],
                {.size = 14, .color = kQuietInk, .align = Align::kCenter});
  }
}

}  // namespace cairn::drawing
