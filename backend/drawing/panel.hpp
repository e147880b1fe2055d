// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "cairn/drawing/canvas.hpp"
#include "cairn/drawing/color_scale.hpp"
#include "cairn/drawing/projection.hpp"
#include "cairn/drawing/scene.hpp"

namespace cairn::drawing {

/// The map's window on the page: what of the view plane is shown where.
struct Window {
  Projection projection{};
  Rect rect{};
  Eigen::Vector2d center_m = Eigen::Vector2d::Zero();  ///< in the view plane
  double units_per_m = 1.0;
  double near_m = 0.0,
         far_m = 0.0;  ///< distance towards the eye of the nearest and the farthest point

  [[nodiscard]] Point to_page(const Eigen::Vector3d& p_map) const;
  /// 0 nearest to the eye, 1 farthest; 0 where the view has no depth.
  [[nodiscard]] double depth(const Eigen::Vector3d& p_map) const;
};

/// The smallest window that shows all points, with a margin. A single point gets a window of one
/// meter.
Window fit_window(const std::vector<Eigen::Vector3d>& points, const Projection& projection,
                  const Rect& rect);

/// Draws a scene: truth underneath, then from far to near landmarks, loops (calm ones first) and
/// paths. Where all loops together would hide everything, one of so many is drawn: the number
/// given.
std::size_t draw_scene(Canvas& canvas, const Window& window, const Scene& scene,
                       const std::vector<Path>& truth, const ColorScale& residuals);

/// A bar of round length in the window's lower left corner, and the axes where the view is oblique.
void draw_scale_bar(Canvas& canvas, const Window& window);
void draw_axes(Canvas& canvas, const Window& window);

}  // namespace cairn::drawing
