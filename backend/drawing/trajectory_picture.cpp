// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/drawing/trajectory_picture.hpp"

#include <algorithm>
#include <cmath>

#include "cairn/drawing/error_chart.hpp"
#include "cairn/drawing/legend.hpp"
#include "cairn/drawing/panel.hpp"
#include "cairn/drawing/thinning.hpp"

namespace cairn {
namespace {

using namespace drawing;
using Eigen::Vector3d;

constexpr double kSide = 28.0, kTop = 92.0, kBottom = 92.0;
constexpr double kChartInset = 70.0;  // room for the axis labels

std::optional<Error> why_not_drawable(const TrajectoryErrors& errors) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::kBadInput, why}; };
  if (errors.reference.empty() || errors.estimate.empty())
    return refuse("a trajectory without poses cannot be drawn");
  if (errors.error.empty()) return refuse("no errors to draw: the trajectories share no poses");
  if (errors.index.size() != errors.error.size() || errors.path_m.size() != errors.error.size()) {
    return refuse("index, path and error of a trajectory picture differ in length");
  }
  const auto finite = [](const Vector3d& p) { return p.allFinite(); };
  const auto finite_number = [](double x) { return std::isfinite(x); };
  if (!std::all_of(errors.reference.begin(), errors.reference.end(), finite) ||
      !std::all_of(errors.estimate.begin(), errors.estimate.end(), finite) ||
      !std::all_of(errors.error.begin(), errors.error.end(), finite_number) ||
      !std::all_of(errors.path_m.begin(), errors.path_m.end(), finite_number)) {
    return refuse("a trajectory with positions or errors that are not finite cannot be drawn");
  }
  const bool in_range = std::is_sorted(errors.index.begin(), errors.index.end()) &&
                        errors.index.back() < errors.estimate.size();
  if (!in_range) return refuse("indices of a trajectory picture must ascend within the estimate");
  return std::nullopt;
}

// The error at every pose of the estimate: interpolated between those that have one.
std::vector<double> error_at_poses(const TrajectoryErrors& errors) {
  std::vector<double> at(errors.estimate.size(), errors.error.back());
  std::fill(at.begin(), at.begin() + static_cast<std::ptrdiff_t>(errors.index.front()),
            errors.error.front());
  for (std::size_t k = 0; k + 1 < errors.index.size(); ++k) {
    const std::size_t begin = errors.index[k], end = errors.index[k + 1];
    for (std::size_t i = begin; i < end; ++i) {
      const double t = static_cast<double>(i - begin) / static_cast<double>(end - begin);
      at[i] = errors.error[k] + t * (errors.error[k + 1] - errors.error[k]);
    }
  }
  return at;
}

std::vector<Stroke> strokes_of(const Window& window, const std::vector<Vector3d>& positions) {
  std::vector<Stroke> strokes;
  for (std::size_t i = 1; i < positions.size(); ++i) {
    strokes.push_back({{window.to_page(positions[i - 1]), window.to_page(positions[i])}, 0.0F, 0});
  }
  return strokes;
}

void draw_reference(Canvas& canvas, const Window& window, const std::vector<Vector3d>& positions) {
  std::vector<Stroke> strokes = joined_steps(strokes_of(window, positions), 0.5);
  drop_covered(strokes, 0.4, canvas.segment_budget());
  std::vector<Segment> lines;
  for (const Stroke& stroke : strokes) lines.push_back(stroke.line);
  canvas.lines(lines, {.color = kTruth, .width = 1.4});
}

void draw_estimate(Canvas& canvas, const Window& window, const TrajectoryErrors& errors,
                   const ColorScale& scale) {
  const std::vector<double> error = error_at_poses(errors);
  std::vector<Stroke> strokes = strokes_of(window, errors.estimate);
  for (std::size_t i = 0; i < strokes.size(); ++i)
    strokes[i].layer = scale.bin((error[i] + error[i + 1]) / 2);
  drop_covered(strokes, 0.4, canvas.segment_budget());
  std::stable_sort(strokes.begin(), strokes.end(),
                   [](const Stroke& a, const Stroke& b) { return a.layer < b.layer; });
  std::vector<Segment> group;
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    group.push_back(strokes[i].line);
    if (i + 1 < strokes.size() && strokes[i].layer == strokes[i + 1].layer) continue;
    canvas.lines(group, {.color = ColorScale::bin_color(strokes[i].layer), .width = 2.2});
    group.clear();
  }
}

void draw_map(Canvas& canvas, const Rect& rect, const TrajectoryErrors& errors,
              const ColorScale& scale) {
  std::vector<Vector3d> points = errors.reference;
  points.insert(points.end(), errors.estimate.begin(), errors.estimate.end());
  const Window window = fit_window(points, choose_projection(points), rect);
  canvas.clip(rect);
  draw_reference(canvas, window, errors.reference);
  draw_estimate(canvas, window, errors, scale);
  canvas.circle(window.to_page(errors.estimate.front()), 5.0, {.color = kInk, .width = 2.0});
  canvas.unclip();
  canvas.frame(rect, {.color = kHairline});
  draw_scale_bar(canvas, window);
  draw_axes(canvas, window);
}

}  // namespace

Result<void> draw_trajectory_errors(const TrajectoryErrors& errors, const std::string& path,
                                    const PictureOptions& options) {
  if (auto error = why_not_drawable(errors)) return *error;
  Result<Canvas> canvas = Canvas::create(path, options);
  if (!canvas) return canvas.error();

  const ColorScale scale = choose_color_scale(errors.error);
  const double map_width = 0.54 * canvas->width() - kSide;
  const double height = canvas->height() - kTop - kBottom;
  const double chart_x = kSide + map_width + kChartInset;
  draw_heading(*canvas, options.title, errors.summary);
  draw_map(*canvas, {kSide, kTop, map_width, height}, errors, scale);
  draw_error_chart(*canvas, {chart_x, kTop, canvas->width() - kSide - chart_x, height}, errors,
                   scale);
  draw_keys(*canvas, {kSide, canvas->height() - kBottom / 2 + 10}, {{"reference", kTruth}});
  draw_color_bar(*canvas, {kSide + map_width - 310, canvas->height() - kBottom / 2, 300, 10}, scale,
                 "estimate: " + errors.error_label);
  return canvas->finish();
}

}  // namespace cairn
