// SPDX-License-Identifier: BSD-3-Clause
#include "benchmarks/support/line_chart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cairn/drawing/canvas.hpp"
#include "cairn/drawing/ruler.hpp"

namespace cairn::bench {
namespace {

using drawing::Align;
using drawing::Canvas;
using drawing::Point;
using drawing::Rect;

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;

  void take(double value) { low = std::min(low, value), high = std::max(high, value); }
  void widen() { low = drawing::round_down_125(low), high = drawing::round_up_125(high); }
  // 0 at the low end, 1 at the high one.
  [[nodiscard]] double part(double value) const {
    return high > low ? std::log(value / low) / std::log(high / low) : 0.5;
  }
};

// 1, 2 and 5 times powers of ten.
std::vector<double> ticks(const Range& range) {
  std::vector<double> found;
  for (double tick = range.low; tick <= 1.001 * range.high;
       tick = drawing::round_up_125(1.1 * tick))
    found.push_back(tick);
  return found;
}

struct Axes {
  Rect rect;
  Range x, y;

  [[nodiscard]] Point at(double x_value, double y_value) const {
    return {rect.x + x.part(x_value) * rect.width, rect.y + (1.0 - y.part(y_value)) * rect.height};
  }
};

void draw_grid(Canvas& canvas, const Axes& axes, const LineChart& chart) {
  const Rect& r = axes.rect;
  const drawing::TextStyle label{.size = 16, .color = drawing::kQuietInk, .align = Align::kRight};
  for (const double tick : ticks(axes.y)) {
    const double y = axes.at(axes.x.low, tick).y();
    canvas.polyline(std::vector<Point>{{r.x, y}, {r.x + r.width, y}},
                    {.color = drawing::kHairline});
    canvas.text({r.x - 10, y + 5}, drawing::format_number(tick, 6), label);
  }
  for (const double tick : ticks(axes.x)) {
    const double x = axes.at(tick, axes.y.low).x();
    canvas.polyline(std::vector<Point>{{x, r.y}, {x, r.y + r.height}},
                    {.color = drawing::kHairline});
    canvas.text({x, r.y + r.height + 24}, drawing::format_number(tick, 6),
                {.size = 16, .color = drawing::kQuietInk, .align = Align::kCenter});
  }
  canvas.text({r.x - 60, r.y - 22}, chart.y_label, {.size = 17});
  canvas.text({r.x + r.width, r.y + r.height + 56}, chart.x_label,
              {.size = 17, .align = Align::kRight});
}

void draw_series(Canvas& canvas, const Axes& axes, const Series& series, std::size_t number) {
  const drawing::Color color = drawing::robot_color(number);
  std::vector<Point> line;
  for (const auto& [x, y] : series.points) line.push_back(axes.at(x, y));
  canvas.polyline(line, {.color = color, .width = 2.5});
  for (const Point& point : line) canvas.disk(point, 4.5, color);
  if (!line.empty())
    canvas.text(line.back() + Point(12, 6), series.name, {.size = 16, .color = color});
}

}  // namespace

Result<void> draw(const LineChart& chart, const std::string& path) {
  Result<Canvas> canvas = Canvas::create(path, {.title = chart.title});
  if (!canvas) return canvas.error();
  Axes axes{{110, 120, canvas->width() - 380, canvas->height() - 220}, {}, {}};
  for (const Series& series : chart.series)
    for (const auto& [x, y] : series.points) axes.x.take(x), axes.y.take(y);
  axes.x.widen(), axes.y.widen();
  canvas->text({60, 56}, chart.title, {.size = 22, .bold = true});
  draw_grid(*canvas, axes, chart);
  for (std::size_t i = 0; i < chart.series.size(); ++i)
    draw_series(*canvas, axes, chart.series[i], i);
  return canvas->finish();
}

}  // namespace cairn::bench
