// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/drawing/canvas.hpp"

#include <cairo-svg.h>
#include <cairo.h>

#include <algorithm>
#include <cstring>
#include <numbers>
#include <optional>

#include "cairn/core/output_file.hpp"
#include "cairn/drawing/utf8.hpp"

namespace cairn::drawing {
namespace {

constexpr double kPageWidth = 1200.0;
constexpr double kPageHeight = 900.0;
// A stroke of very many segments takes cairo more than linear time.
constexpr std::size_t kSegmentsPerStroke = 1000;
constexpr std::size_t kVectorBudget = 25'000;
constexpr std::size_t kPixelBudget = 150'000;

bool ends_with(std::string_view text, std::string_view end) {
  return text.size() > end.size() && text.substr(text.size() - end.size()) == end;
}

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

struct Canvas::State {
  std::string path;
  bool is_vector = false;
  double width = 0.0, height = 0.0;  // page units
  std::string bytes;                 // of the file; vector output arrives while drawing
  cairo_surface_t* surface = nullptr;
  cairo_t* context = nullptr;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    cairo_destroy(context);
    cairo_surface_destroy(surface);
  }

  void set(const LineStyle& style) const {
    set(style.color);
    cairo_set_line_width(context, style.width);
    cairo_set_dash(context, &style.dash, style.dash > 0.0 ? 1 : 0, 0.0);
  }
  void set(const Color& color) const {
    cairo_set_source_rgba(context, color.red, color.green, color.blue, color.alpha);
  }
  void set(const TextStyle& style) const {
    set(style.color);
    cairo_select_font_face(context, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(context, style.size);
  }
};

Canvas::Canvas(std::unique_ptr<State> state) : state_(std::move(state)) {}
Canvas::Canvas(Canvas&&) noexcept = default;
Canvas::~Canvas() = default;

Result<Canvas> Canvas::create(const std::string& path, const PictureOptions& options) {
  if (Result<void> checked = check_picture(path, options); !checked) return checked.error();
  auto state = std::make_unique<State>();
  state->path = path;
  state->is_vector = ends_with(path, ".svg");
  const double scale = std::min(options.width_px / kPageWidth, options.height_px / kPageHeight);
  state->width = options.width_px / scale;
  state->height = options.height_px / scale;
  state->surface =
      state->is_vector
          ? cairo_svg_surface_create_for_stream(append, &state->bytes, options.width_px,
                                                options.height_px)
          : cairo_image_surface_create(CAIRO_FORMAT_RGB24, options.width_px, options.height_px);
  state->context = cairo_create(state->surface);
  cairo_scale(state->context, scale, scale);
  cairo_set_line_cap(state->context, CAIRO_LINE_CAP_ROUND);
  cairo_set_line_join(state->context, CAIRO_LINE_JOIN_ROUND);
  state->set(kPaper);
  cairo_paint(state->context);
  return Canvas(std::move(state));
}

double Canvas::width() const { return state_->width; }
double Canvas::height() const { return state_->height; }
std::size_t Canvas::segment_budget() const {
  return state_->is_vector ? kVectorBudget : kPixelBudget;
}

void Canvas::clip(const Rect& rect) {
  cairo_save(state_->context);
  cairo_rectangle(state_->context, rect.x, rect.y, rect.width, rect.height);
  cairo_clip(state_->context);
}

void Canvas::unclip() { cairo_restore(state_->context); }

void Canvas::lines(std::span<const Segment> segments, const LineStyle& style) {
  state_->set(style);
  for (std::size_t begin = 0; begin < segments.size(); begin += kSegmentsPerStroke) {
    const auto chunk =
        segments.subspan(begin, std::min(kSegmentsPerStroke, segments.size() - begin));
    for (std::size_t i = 0; i < chunk.size(); ++i) {
      const bool goes_on = i > 0 && chunk[i].a == chunk[i - 1].b;
      if (!goes_on) cairo_move_to(state_->context, chunk[i].a.x(), chunk[i].a.y());
      cairo_line_to(state_->context, chunk[i].b.x(), chunk[i].b.y());
    }
    cairo_stroke(state_->context);
  }
}

void Canvas::polyline(std::span<const Point> points, const LineStyle& style) {
  state_->set(style);
  for (const Point& point : points) cairo_line_to(state_->context, point.x(), point.y());
  cairo_stroke(state_->context);
}

void Canvas::rectangle(const Rect& rect, const Color& fill) {
  state_->set(fill);
  cairo_rectangle(state_->context, rect.x, rect.y, rect.width, rect.height);
  cairo_fill(state_->context);
}

void Canvas::frame(const Rect& rect, const LineStyle& style) {
  state_->set(style);
  cairo_rectangle(state_->context, rect.x, rect.y, rect.width, rect.height);
  cairo_stroke(state_->context);
}

void Canvas::image(const Rect& rect, const GrayImage& image) {
  cairo_surface_t* surface = cairo_image_surface_create(
      CAIRO_FORMAT_RGB24, static_cast<int>(image.width), static_cast<int>(image.height));
  if (unsigned char* pixels = cairo_image_surface_get_data(surface)) {
    const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface));
    for (std::size_t i = 0; i < image.width * image.height; ++i) {
      const auto level = static_cast<unsigned char>(image.levels[i]);
      const std::uint32_t pixel = level * 0x010101U;
      std::memcpy(pixels + i / image.width * stride + 4 * (i % image.width), &pixel, sizeof pixel);
    }
    cairo_surface_mark_dirty(surface);
  }
  cairo_save(state_->context);
  cairo_translate(state_->context, rect.x, rect.y);
  cairo_scale(state_->context, rect.width / static_cast<double>(image.width),
              rect.height / static_cast<double>(image.height));
  cairo_set_source_surface(state_->context, surface, 0.0, 0.0);
  cairo_paint(state_->context);
  cairo_restore(state_->context);
  cairo_surface_destroy(surface);
}

void Canvas::disk(const Point& center, double radius, const Color& fill) {
  state_->set(fill);
  cairo_new_sub_path(state_->context);
  cairo_arc(state_->context, center.x(), center.y(), radius, 0.0, 2 * std::numbers::pi);
  cairo_fill(state_->context);
}

void Canvas::circle(const Point& center, double radius, const LineStyle& style) {
  state_->set(style);
  cairo_new_sub_path(state_->context);
  cairo_arc(state_->context, center.x(), center.y(), radius, 0.0, 2 * std::numbers::pi);
  cairo_stroke(state_->context);
}

void Canvas::text(const Point& position, std::string_view text, const TextStyle& style) {
  const std::string shown = printable_utf8(text);
  const double shift = style.align == Align::kLeft     ? 0.0
                       : style.align == Align::kCenter ? text_width(shown, style) / 2
                                                       : text_width(shown, style);
  state_->set(style);
  cairo_move_to(state_->context, position.x() - shift, position.y());
  cairo_show_text(state_->context, shown.c_str());
  cairo_new_path(state_->context);
}

double Canvas::text_width(std::string_view text, const TextStyle& style) {
  state_->set(style);
  cairo_text_extents_t extents;
  cairo_text_extents(state_->context, printable_utf8(text).c_str(), &extents);
  return extents.x_advance;
}

Result<void> Canvas::finish() {
  cairo_status_t status = cairo_status(state_->context);
  if (status == CAIRO_STATUS_SUCCESS && !state_->is_vector) {
    status = cairo_surface_write_to_png_stream(state_->surface, append, &state_->bytes);
  }
  cairo_surface_finish(state_->surface);
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(state_->surface);
  if (status != CAIRO_STATUS_SUCCESS) {
    return Error{ErrorCode::kInternal,
                 std::string("cairo cannot draw: ") + cairo_status_to_string(status), state_->path};
  }
  return write_file(state_->path, state_->bytes);
}

}  // namespace cairn::drawing

namespace cairn {

Result<void> check_picture(const std::string& path, const PictureOptions& options) {
  constexpr int kSmallest = 200, kLargest = 16384;
  if (!drawing::ends_with(path, ".svg") && !drawing::ends_with(path, ".png")) {
    return Error{ErrorCode::kUsage, "a picture must be named .png or .svg", path};
  }
  for (const int size : {options.width_px, options.height_px}) {
    if (size < kSmallest || size > kLargest) {
      return Error{ErrorCode::kUsage,
                   "a picture of " + std::to_string(options.width_px) + "x" +
                       std::to_string(options.height_px) + " pixels; each side must be between " +
                       std::to_string(kSmallest) + " and " + std::to_string(kLargest),
                   path};
    }
  }
  return {};
}

}  // namespace cairn
