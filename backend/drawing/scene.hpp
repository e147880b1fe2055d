// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "cairn/core/result.hpp"
#include "cairn/graph/graph.hpp"

namespace cairn::drawing {

/// Consecutive poses of one robot that odometry joins, m.
struct Path {
  std::size_t robot = 0;  ///< 0 for the first robot of the graph, 1 for the next ...
  std::vector<Eigen::Vector3d> positions{};
  Eigen::Vector3d heading = Eigen::Vector3d::Zero();  ///< of the first pose: its x axis
};

struct Loop {
  Eigen::Vector3d a, b;
  double residual;  ///< whitened norm, sqrt(e^T Omega e)
};

/// What a picture of a graph shows; planar graphs have z = 0.
struct Scene {
  std::vector<Path> paths;
  std::vector<Loop> loops;
  std::vector<Eigen::Vector3d> landmarks;
  std::size_t poses = 0;
  std::size_t robots = 0;

  /// Every position: of poses and landmarks.
  [[nodiscard]] std::vector<Eigen::Vector3d> points() const;
};

/// The scene of `graph` at `values`. Refused with kBadInput when there is nothing to draw or a
/// position is not finite (which one is named).
Result<Scene> make_scene(const Graph& graph, const Values& values, ErrorChart chart);

}  // namespace cairn::drawing
