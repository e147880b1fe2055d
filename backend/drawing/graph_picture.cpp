// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/drawing/graph_picture.hpp"

#include <algorithm>

#include "cairn/drawing/legend.hpp"
#include "cairn/drawing/panel.hpp"

namespace cairn {
namespace {

using namespace drawing;
using Eigen::Vector3d;

constexpr double kSide = 28.0, kTop = 118.0, kBottom = 92.0, kGutter = 24.0;
constexpr double kOneScale = 5.0;  // panels whose extents differ more get scales of their own

Result<std::vector<Scene>> make_scenes(std::span<const GraphView> views, ErrorChart chart) {
  std::vector<Scene> scenes;
  for (const GraphView& view : views) {
    Result<Scene> scene =
        make_scene(*view.graph, view.values ? *view.values : view.graph->values(), chart);
    if (!scene) return scene.error();
    scenes.push_back(std::move(*scene));
  }
  return scenes;
}

Result<std::vector<Path>> make_truth(const GraphTruth& truth) {
  if (!truth.graph) return std::vector<Path>{};
  Result<Scene> scene = make_scene(*truth.graph, truth.graph->values(), ErrorChart::kG2o);
  if (!scene) return Error{scene.error().code, "the ground truth: " + scene.error().message};
  for (Path& path : scene->paths) {
    for (Vector3d& p : path.positions) p = truth.T_map_truth * p;
  }
  return std::move(scene->paths);
}

ColorScale residual_scale(const std::vector<Scene>& scenes) {
  std::vector<double> residuals;
  for (const Scene& scene : scenes) {
    for (const Loop& loop : scene.loops) residuals.push_back(loop.residual);
  }
  return choose_color_scale(std::move(residuals));
}

// The lower left corner of it (0), or the upper right one (1).
Vector3d corner_of(const Backdrop& backdrop, double which) {
  const Eigen::Vector2d extent(backdrop.image.width, backdrop.image.height);
  const Eigen::Vector2d p = backdrop.p_map_corner + which * backdrop.pixel_m * extent;
  return {p.x(), p.y(), 0.0};
}

void draw_backdrop(Canvas& canvas, const Window& window, const Backdrop& backdrop) {
  const Point low = window.to_page(corner_of(backdrop, 0.0));
  const Point high = window.to_page(corner_of(backdrop, 1.0));
  canvas.clip(window.rect);
  canvas.image({low.x(), high.y(), high.x() - low.x(), low.y() - high.y()}, backdrop.image);
  canvas.unclip();
}

std::vector<Window> place_windows(const Canvas& canvas, std::span<const GraphView> views,
                                  const std::vector<Scene>& scenes,
                                  const std::vector<Path>& truth) {
  const auto count = static_cast<double>(scenes.size());
  const double width = (canvas.width() - 2 * kSide - (count - 1) * kGutter) / count;
  // The last view is the best estimate: it decides from where all are seen.
  const bool from_above = std::any_of(
      views.begin(), views.end(), [](const GraphView& view) { return view.backdrop != nullptr; });
  const Projection projection =
      from_above ? Projection() : choose_projection(scenes.back().points());
  std::vector<Window> windows;
  for (const Scene& scene : scenes) {
    const double x = kSide + static_cast<double>(windows.size()) * (width + kGutter);
    std::vector<Vector3d> points = scene.points();
    for (const Path& path : truth)
      points.insert(points.end(), path.positions.begin(), path.positions.end());
    if (const Backdrop* backdrop = views[windows.size()].backdrop) {
      points.push_back(corner_of(*backdrop, 0.0));
      points.push_back(corner_of(*backdrop, 1.0));
    }
    windows.push_back(
        fit_window(points, projection, {x, kTop, width, canvas.height() - kTop - kBottom}));
  }
  const auto [smallest, largest] = std::minmax_element(
      windows.begin(), windows.end(),
      [](const Window& a, const Window& b) { return a.units_per_m < b.units_per_m; });
  const double common = smallest->units_per_m;
  if (largest->units_per_m <= kOneScale * common) {
    for (Window& window : windows) window.units_per_m = common;
  }
  return windows;
}

std::string count_of(std::size_t count, const std::string& thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

std::string describe(const Graph& graph, const Scene& scene) {
  const std::string dot = " \u00B7 ";
  std::string text = count_of(scene.poses, "pose");
  if (scene.robots > 1) text += " of " + count_of(scene.robots, "robot");
  if (!scene.landmarks.empty()) text += dot + count_of(scene.landmarks.size(), "landmark");
  text += dot + count_of(graph.factor_count(), "factor");
  if (!scene.loops.empty()) text += dot + count_of(scene.loops.size(), "loop closure");
  return text;
}

void draw_legend(Canvas& canvas, const Scene& scene, bool has_truth, const ColorScale& residuals) {
  constexpr double kBarWidth = 300.0, kBarHeight = 10.0;
  std::vector<LegendKey> keys;
  if (scene.poses > 0) keys.push_back({scene.robots > 1 ? "paths" : "path", robot_color(0)});
  if (!scene.landmarks.empty()) keys.push_back({"landmarks", kLandmark, true});
  if (has_truth) keys.push_back({"ground truth", kTruth});
  const double middle = canvas.height() - kBottom / 2;
  draw_keys(canvas, {kSide, middle + 10}, keys);
  if (scene.loops.empty()) return;
  const Rect bar{canvas.width() - kSide - kBarWidth - 10, middle, kBarWidth, kBarHeight};
  draw_color_bar(canvas, bar, residuals, "loop closures by residual (whitened norm)");
}

}  // namespace

Result<void> draw_graphs(std::span<const GraphView> views, const std::string& path,
                         const PictureOptions& options, const GraphTruth& truth, ErrorChart chart) {
  CAIRN_CHECK(!views.empty(), "draw_graphs needs a view");
  Result<std::vector<Scene>> scenes = make_scenes(views, chart);
  if (!scenes) return scenes.error();
  Result<std::vector<Path>> true_paths = make_truth(truth);
  if (!true_paths) return true_paths.error();
  Result<Canvas> canvas = Canvas::create(path, options);
  if (!canvas) return canvas.error();

  const ColorScale residuals = residual_scale(*scenes);
  const std::vector<Window> windows = place_windows(*canvas, views, *scenes, *true_paths);
  draw_heading(*canvas, options.title, describe(*views.back().graph, scenes->back()));
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const Rect& rect = windows[i].rect;
    if (views[i].backdrop) draw_backdrop(*canvas, windows[i], *views[i].backdrop);
    const std::size_t one_of =
        draw_scene(*canvas, windows[i], (*scenes)[i], *true_paths, residuals);
    const std::string sample =
        one_of == 1 ? "" : " (1 of " + std::to_string(one_of) + " loops drawn)";
    canvas->text({rect.x, rect.y - 12}, views[i].caption + sample, {.size = 17});
    canvas->frame(rect, {.color = kHairline});
    draw_scale_bar(*canvas, windows[i]);
    draw_axes(*canvas, windows[i]);
  }
  draw_legend(*canvas, scenes->back(), truth.graph != nullptr, residuals);
  return canvas->finish();
}

}  // namespace cairn
