// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/drawing/legend.hpp"

#include "cairn/drawing/ruler.hpp"
#include "cairn/drawing/utf8.hpp"

namespace cairn::drawing {

void draw_heading(Canvas& canvas, const std::string& title, const std::string& numbers) {
  constexpr double kInset = 28.0;
  TextStyle style{.size = 24, .bold = true};
  std::size_t characters = 120;
  std::string shown = shortened(title, characters);
  while (characters > 8 && canvas.text_width(shown, style) > canvas.width() - 2 * kInset) {
    shown = shortened(title, characters -= 4);
  }
  canvas.text({kInset, 42}, shown, style);
  canvas.text({kInset, 68}, numbers, {.size = 16, .color = kQuietInk});
}

void draw_keys(Canvas& canvas, const Point& position, const std::vector<LegendKey>& keys) {
  constexpr double kSample = 26.0, kGap = 8.0, kBetween = 28.0;
  const TextStyle style{.size = 15};
  Point at = position;
  for (const LegendKey& key : keys) {
    const Point middle = at + Point(kSample / 2, -5.0);
    if (key.is_dot) {
      canvas.disk(middle, 3.5, key.color);
    } else {
      canvas.polyline(
          std::vector<Point>{middle - Point(kSample / 2, 0), middle + Point(kSample / 2, 0)},
          {.color = key.color, .width = 2.2});
    }
    at.x() += kSample + kGap;
    canvas.text(at, key.name, style);
    at.x() += canvas.text_width(key.name, style) + kBetween;
  }
}

void draw_color_bar(Canvas& canvas, const Rect& rect, const ColorScale& scale,
                    const std::string& label) {
  const double step = rect.width / ColorScale::kBins;
  for (int bin = 0; bin < ColorScale::kBins; ++bin) {
    // Overlap by a hair, so that no paper shines through between the colours.
    canvas.rectangle({rect.x + bin * step, rect.y, step + 0.4, rect.height},
                     ColorScale::bin_color(bin));
  }
  const std::vector<double> ticks = scale.ticks();
  for (const double tick : ticks) {
    const double x = rect.x + scale.position(tick) * rect.width;
    const double bottom = rect.y + rect.height;
    canvas.polyline(std::vector<Point>{{x, bottom}, {x, bottom + 4}}, {.color = kQuietInk});
    const bool is_end = scale.clipped && tick == ticks.back() && scale.position(tick) > 0.999;
    canvas.text({x, bottom + 18}, (is_end ? "\u2265 " : "") + format_number(tick, 5),
                {.size = 13, .color = kQuietInk, .align = Align::kCenter});
  }
  canvas.text({rect.x + rect.width, rect.y - 7}, label, {.size = 15, .align = Align::kRight});
}

}  // namespace cairn::drawing
