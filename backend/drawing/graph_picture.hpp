// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <string>

#include "cairn/core/result.hpp"
#include "cairn/drawing/gray_image.hpp"
#include "cairn/drawing/picture.hpp"
#include "cairn/graph/graph.hpp"

namespace cairn {

/// One panel of a picture: a graph at some values.
struct GraphView {
  const Graph* graph = nullptr;
  const Values* values = nullptr;      ///< null: those of the graph
  std::string caption{};               ///< "after: chi2 3549.04"
  const Backdrop* backdrop = nullptr;  ///< a map under it; then all views are from above
};

/// The true poses, drawn underneath every view.
struct GraphTruth {
  const Graph* graph = nullptr;  ///< null: not known
  Eigen::Isometry3d T_map_truth = Eigen::Isometry3d::Identity();
};

/// Draws the views side by side: paths, landmarks, and loop closures coloured by
/// residual (whitened norm, in `chart`). Panels have one scale unless their extents differ more
/// than fivefold; each has a scale bar. Spatial graphs are seen from one well-chosen side, fading
/// with depth. Refused with kBadInput when a graph is empty or a position is not finite.
Result<void> draw_graphs(std::span<const GraphView> views, const std::string& path,
                         const PictureOptions& options = {}, const GraphTruth& truth = {},
                         ErrorChart chart = ErrorChart::kG2o);

}  // namespace cairn
