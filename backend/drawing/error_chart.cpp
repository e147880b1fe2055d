// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/drawing/error_chart.hpp"

#include <algorithm>
#include <cmath>

#include "cairn/drawing/ruler.hpp"
#include "cairn/drawing/thinning.hpp"

namespace cairn::drawing {
namespace {

// Maps (path m, error) to the page.
struct Axes {
  Rect rect;
  double path_low_m, path_high_m, error_high;

  [[nodiscard]] Point to_page(double path_m, double error) const {
    return {rect.x + (path_m - path_low_m) / (path_high_m - path_low_m) * rect.width,
            rect.y + rect.height - error / error_high * rect.height};
  }
};

Axes choose_axes(const Rect& rect, const TrajectoryErrors& errors) {
  const auto [low, high] = std::minmax_element(errors.path_m.begin(), errors.path_m.end());
  const double largest = *std::max_element(errors.error.begin(), errors.error.end());
  return {rect, *low, *high > *low ? *high : *low + 1.0, largest > 0.0 ? 1.08 * largest : 1.0};
}

void draw_grid(Canvas& canvas, const Axes& axes) {
  const Rect& r = axes.rect;
  const TextStyle label{.size = 14, .color = kQuietInk, .align = Align::kRight};
  for (const double tick : linear_ticks(0.0, axes.error_high, 6)) {
    const double y = axes.to_page(axes.path_low_m, tick).y();
    canvas.polyline(std::vector<Point>{{r.x, y}, {r.x + r.width, y}}, {.color = kHairline});
    canvas.text({r.x - 8, y + 5}, format_number(tick, 4), label);
  }
  for (const double tick : linear_ticks(axes.path_low_m, axes.path_high_m, 6)) {
    const double x = axes.to_page(tick, 0.0).x(), bottom = r.y + r.height;
    canvas.polyline(std::vector<Point>{{x, bottom}, {x, bottom + 5}}, {.color = kQuietInk});
    canvas.text({x, bottom + 22}, format_number(tick, 6),
                {.size = 14, .color = kQuietInk, .align = Align::kCenter});
  }
  canvas.polyline(std::vector<Point>{{r.x, r.y + r.height}, {r.x + r.width, r.y + r.height}},
                  {.color = kQuietInk});
}

void draw_curve(Canvas& canvas, const Axes& axes, const TrajectoryErrors& errors,
                const ColorScale& scale) {
  std::vector<Stroke> strokes;
  for (std::size_t i = 1; i < errors.error.size(); ++i) {
    strokes.push_back({{axes.to_page(errors.path_m[i - 1], errors.error[i - 1]),
                        axes.to_page(errors.path_m[i], errors.error[i])},
                       0.0F,
                       scale.bin((errors.error[i - 1] + errors.error[i]) / 2)});
  }
  drop_covered(strokes, 0.4, canvas.segment_budget());
  for (const Stroke& stroke : strokes) {
    canvas.lines({&stroke.line, 1}, {.color = ColorScale::bin_color(stroke.layer), .width = 1.8});
  }
  if (strokes.empty()) {
    canvas.disk(axes.to_page(errors.path_m[0], errors.error[0]), 3.0,
                ColorScale::bin_color(scale.bin(errors.error[0])));
  }
}

void draw_level(Canvas& canvas, const Axes& axes, double value, const std::string& name) {
  const Point left = axes.to_page(axes.path_low_m, value);
  const Point right(axes.rect.x + axes.rect.width, left.y());
  canvas.polyline(std::vector<Point>{left, right}, {.color = kInk, .width = 1.2, .dash = 5.0});
  const std::string label = name + " " + format_number(value, 4);
  const TextStyle style{.size = 14, .align = Align::kRight};
  const double width = canvas.text_width(label, style) + 8;
  canvas.rectangle({right.x() - width, right.y() - 21, width, 18}, with_alpha(kPaper, 0.85));
  canvas.text(right - Point(4, 7), label, style);
}

}  // namespace

void draw_error_chart(Canvas& canvas, const Rect& rect, const TrajectoryErrors& errors,
                      const ColorScale& scale) {
  const Axes axes = choose_axes(rect, errors);
  draw_grid(canvas, axes);
  draw_curve(canvas, axes, errors, scale);
  double squares = 0.0;
  for (const double e : errors.error) squares += e * e;
  draw_level(canvas, axes, std::sqrt(squares / static_cast<double>(errors.error.size())), "rmse");
  canvas.text({rect.x - 42, rect.y - 14}, errors.error_label, {.size = 15});
  canvas.text({rect.x + rect.width, rect.y + rect.height + 46}, "path [m]",
              {.size = 15, .align = Align::kRight});
}

}  // namespace cairn::drawing
