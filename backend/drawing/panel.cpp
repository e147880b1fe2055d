// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/drawing/panel.hpp"

#include <algorithm>
#include <cmath>

#include "cairn/drawing/thinning.hpp"

namespace cairn::drawing {
namespace {

using Eigen::Vector3d;

constexpr int kDepthBins = 16;
constexpr double kFade = 0.62;  // how far the farthest lines fade into the paper
constexpr double kCell = 0.4;   // page units: closer lines are not told apart
constexpr double kStep = 0.5;   // page units
// Layers of one depth, from below: loops by colour, then one per robot.
constexpr int kFirstRobotLayer = ColorScale::kBins;
constexpr std::size_t kRobotLayers = 8;
constexpr int kTruthLayer = kFirstRobotLayer + static_cast<int>(kRobotLayers);

int depth_bin(const Stroke& stroke) {
  return std::min(static_cast<int>(stroke.depth * kDepthBins), kDepthBins - 1);
}

Color faded(const Color& color, double depth) {
  return with_alpha(mix(color, kPaper, kFade * depth), color.alpha);
}

Stroke stroke_between(const Window& window, const Vector3d& a, const Vector3d& b, int layer) {
  return {{window.to_page(a), window.to_page(b)},
          static_cast<float>((window.depth(a) + window.depth(b)) / 2),
          layer};
}

std::vector<Stroke> path_strokes(const Window& window, const std::vector<Path>& paths,
                                 std::size_t budget) {
  std::vector<Stroke> all;
  for (const Path& path : paths) {
    const int layer = kFirstRobotLayer + static_cast<int>(path.robot % kRobotLayers);
    std::vector<Stroke> steps;
    for (std::size_t i = 1; i < path.positions.size(); ++i) {
      steps.push_back(stroke_between(window, path.positions[i - 1], path.positions[i], layer));
    }
    steps = joined_steps(steps, kStep);
    all.insert(all.end(), steps.begin(), steps.end());
  }
  drop_covered(all, kCell, budget);
  return all;
}

std::vector<Stroke> loop_strokes(const Window& window, const Scene& scene,
                                 const ColorScale& residuals, std::size_t budget) {
  std::vector<Stroke> all;
  all.reserve(scene.loops.size());
  for (const Loop& loop : scene.loops) {
    all.push_back(stroke_between(window, loop.a, loop.b, residuals.bin(loop.residual)));
  }
  drop_covered(all, kCell, budget);
  return all;
}

// Many lines are drawn thin, few of them strong.
double weight_for(std::size_t count) {
  return std::clamp(2.6 - 0.45 * std::log10(static_cast<double>(std::max<std::size_t>(count, 1))),
                    0.5, 1.8);
}

struct Pens {
  double path_width = 1.0, loop_width = 1.0, loop_alpha = 1.0;
};

Pens choose_pens(const Scene& scene) {
  const std::size_t loops = scene.loops.size();
  return {.path_width = weight_for(scene.poses),
          .loop_width = std::min(1.2, 0.9 * weight_for(loops)),
          .loop_alpha = loops > 50'000 ? 0.4
                        : loops > 300  ? 0.75
                                       : 0.9};
}

LineStyle style_of(const Stroke& stroke, const Pens& pens) {
  const double depth = (depth_bin(stroke) + 0.5) / kDepthBins * (stroke.depth > 0.0F ? 1.0 : 0.0);
  if (stroke.layer < kFirstRobotLayer) {
    const Color color = with_alpha(ColorScale::bin_color(stroke.layer), pens.loop_alpha);
    return {.color = faded(color, depth), .width = pens.loop_width * (1 - 0.4 * depth)};
  }
  const Color color = stroke.layer == kTruthLayer
                          ? kTruth
                          : robot_color(static_cast<std::size_t>(stroke.layer - kFirstRobotLayer));
  return {.color = faded(color, depth), .width = pens.path_width * (1 - 0.4 * depth)};
}

void draw_strokes(Canvas& canvas, std::vector<Stroke> strokes, const Pens& pens) {
  const auto order = [](const Stroke& s) { return std::pair(-depth_bin(s), s.layer); };
  std::stable_sort(strokes.begin(), strokes.end(),
                   [&](const Stroke& a, const Stroke& b) { return order(a) < order(b); });
  std::vector<Segment> group;
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    group.push_back(strokes[i].line);
    if (i + 1 < strokes.size() && order(strokes[i]) == order(strokes[i + 1])) continue;
    canvas.lines(group, style_of(strokes[i], pens));
    group.clear();
  }
}

void draw_truth(Canvas& canvas, const Window& window, const std::vector<Path>& truth) {
  std::size_t poses = 0;
  for (const Path& path : truth) poses += path.positions.size();
  std::vector<Stroke> strokes = path_strokes(window, truth, canvas.segment_budget());
  for (Stroke& stroke : strokes) stroke.layer = kTruthLayer;
  draw_strokes(canvas, std::move(strokes), {.path_width = 0.8 * weight_for(poses)});
}

// One dot per visible place: what falls on the same spot is drawn once.
void draw_dots(Canvas& canvas, const Window& window, const std::vector<Vector3d>& points,
               double radius, const Color& color) {
  std::vector<Stroke> dots;
  dots.reserve(points.size());
  for (const Vector3d& p_map : points) dots.push_back(stroke_between(window, p_map, p_map, 0));
  drop_covered(dots, kCell, canvas.segment_budget());
  for (const Stroke& dot : dots) canvas.disk(dot.line.a, radius, faded(color, dot.depth));
}

void draw_landmarks(Canvas& canvas, const Window& window, const std::vector<Vector3d>& landmarks) {
  draw_dots(canvas, window, landmarks, std::clamp(1.5 * weight_for(landmarks.size()), 1.0, 3.2),
            kLandmark);
}

// Every pose where they are few, otherwise those that no odometry joins to others.
void draw_poses(Canvas& canvas, const Window& window, const Scene& scene) {
  constexpr std::size_t kFewPoses = 150;
  const bool few = scene.poses <= kFewPoses;
  std::vector<Vector3d> poses;
  for (const Path& path : scene.paths) {
    if (few || path.positions.size() == 1)
      poses.insert(poses.end(), path.positions.begin(), path.positions.end());
  }
  draw_dots(canvas, window, poses, few ? 2.4 : 1.0, kInk);
}

// Where every robot starts and which way it looks.
void draw_starts(Canvas& canvas, const Window& window, const Scene& scene) {
  constexpr double kRadius = 5.0, kHeading = 16.0;
  std::size_t next_robot = 0;
  for (const Path& path : scene.paths) {
    if (path.robot != next_robot) continue;
    ++next_robot;
    const LineStyle style{.color = robot_color(path.robot), .width = 2.0};
    const Point start = window.to_page(path.positions.front());
    const Vector3d in_view = window.projection * path.heading;
    canvas.polyline(std::vector<Point>{start, start + kHeading * Point(in_view.x(), -in_view.y())},
                    style);
    canvas.disk(start, kRadius, kPaper);
    canvas.circle(start, kRadius, style);
  }
}

// Keeps every n-th line where all of them would cover the window many times over; gives n.
std::size_t sample_by_ink(std::vector<Stroke>& strokes, const Window& window, double line_width) {
  constexpr double kMostCoats = 6.0;
  double ink = 0.0;
  for (const Stroke& stroke : strokes) ink += (stroke.line.b - stroke.line.a).norm() * line_width;
  const double coats = ink / (window.rect.width * window.rect.height);
  const auto every = static_cast<std::size_t>(std::ceil(std::max(coats / kMostCoats, 1.0)));
  std::vector<Stroke> kept;
  for (std::size_t i = 0; i < strokes.size(); i += every) kept.push_back(strokes[i]);
  strokes = std::move(kept);
  return every;
}

}  // namespace

std::size_t draw_scene(Canvas& canvas, const Window& window, const Scene& scene,
                       const std::vector<Path>& truth, const ColorScale& residuals) {
  const Pens pens = choose_pens(scene);
  canvas.clip(window.rect);
  draw_truth(canvas, window, truth);
  draw_landmarks(canvas, window, scene.landmarks);
  std::vector<Stroke> strokes = loop_strokes(window, scene, residuals, canvas.segment_budget());
  const std::size_t one_of = sample_by_ink(strokes, window, pens.loop_width);
  const std::vector<Stroke> paths = path_strokes(window, scene.paths, canvas.segment_budget());
  strokes.insert(strokes.end(), paths.begin(), paths.end());
  draw_strokes(canvas, std::move(strokes), pens);
  draw_poses(canvas, window, scene);
  draw_starts(canvas, window, scene);
  canvas.unclip();
  return one_of;
}

}  // namespace cairn::drawing
