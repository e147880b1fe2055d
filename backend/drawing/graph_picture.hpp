// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <string>

#include "cairn/core/result.hpp"
#include "cairn/drawing/picture.hpp"
#include "cairn/graph/graph.hpp"

namespace cairn {

/// One panel of a picture: the graph at some values.
struct GraphView {
  std::string caption{};           ///< "after: chi2 3549.04"
  const Values* values = nullptr;  ///< null: those of the graph
};

/// The true poses, drawn underneath every view.
struct GraphTruth {
  const Graph* graph = nullptr;  ///< null: not known
  Eigen::Isometry3d T_map_truth = Eigen::Isometry3d::Identity();
};

/// Draws `graph` once per view, side by side: paths, landmarks, and loop closures coloured by
/// residual (whitened norm, in `chart`). Panels have one scale unless their extents differ more
/// than fivefold; each has a scale bar. Spatial graphs are seen from one well-chosen side, fading
/// with depth. Refused with kBadInput when a graph is empty or a position is not finite.
Result<void> draw_graph(const Graph& graph, std::span<const GraphView> views,
                        const std::string& path, const PictureOptions& options = {},
                        const GraphTruth& truth = {}, ErrorChart chart = ErrorChart::kG2o);

}  // namespace cairn
