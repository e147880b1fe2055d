// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "cairn/core/result.hpp"
#include "cairn/drawing/color.hpp"
#include "cairn/drawing/gray_image.hpp"
#include "cairn/drawing/picture.hpp"

namespace cairn::drawing {

using Point = Eigen::Vector2d;  ///< on the page: x right, y down

struct Rect {
  double x, y, width, height;
  [[nodiscard]] Point center() const { return {x + width / 2, y + height / 2}; }
};

struct Segment {
  Point a, b;
};

enum class Align { kLeft, kCenter, kRight };

struct TextStyle {
  double size = 15.0;
  Color color = kInk;
  Align align = Align::kLeft;
  bool bold = false;
};

struct LineStyle {
  Color color = kInk;
  double width = 1.0;
  double dash = 0.0;  ///< length of dashes and gaps; 0 is a solid line
};

/// A white page for a .png or .svg file. Lengths are in page units: the page is 900 units high or
/// 1200 wide, whichever makes it larger, so pictures of any size look alike.
class Canvas {
 public:
  static Result<Canvas> create(const std::string& path, const PictureOptions& options);
  Canvas(Canvas&&) noexcept;
  ~Canvas();

  [[nodiscard]] double width() const;
  [[nodiscard]] double height() const;
  /// How many line segments one layer may have: vector files keep every one of them, pixels forget.
  [[nodiscard]] std::size_t segment_budget() const;

  void clip(const Rect& rect);
  void unclip();
  void lines(std::span<const Segment> segments, const LineStyle& style);
  void polyline(std::span<const Point> points, const LineStyle& style);
  void rectangle(const Rect& rect, const Color& fill);
  void frame(const Rect& rect, const LineStyle& style);
  /// An image that fills `rect`. One that cairo has no memory for makes finish() fail.
  void image(const Rect& rect, const GrayImage& image);
  void disk(const Point& center, double radius, const Color& fill);
  void circle(const Point& center, double radius, const LineStyle& style);
  /// Text on a base line at `position`, with invalid UTF-8 shown as '?'.
  void text(const Point& position, std::string_view text, const TextStyle& style = {});
  [[nodiscard]] double text_width(std::string_view text, const TextStyle& style = {});

  /// Writes the file: temporary name first, then renamed.
  Result<void> finish();

 private:
  struct State;
  explicit Canvas(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace cairn::drawing
