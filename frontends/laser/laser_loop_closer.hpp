// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "frontends/matching/correlative.hpp"
#include "frontends/matching/point_to_line.hpp"

namespace cairn {

struct LaserLoopOptions {
  std::size_t least_apart = 20;     ///< keyframes between the ends of a loop
  double radius_m = 2.5;            ///< of candidates around the pose, beside its uncertainty
  std::size_t submap_half = 5;      ///< keyframes before and after a candidate make its submap
  std::size_t most_candidates = 2;  ///< per keyframe
  SearchWindow window{1.5, 1.5, 0.5};
  double least_score = 0.5;
  double least_inliers = 0.6;  ///< of the points that have a line
  LikelihoodGrid::Options grid{};
  PointToLineOptions matching{.first_reach_m = 0.25};
};

struct LoopKeyframe {
  Se2 T_map_laser;
  const std::vector<SurfacePoint>* points;
};

struct LaserLoop {
  std::size_t from, to;  ///< keyframes
  Se2 T_from_to;
  Eigen::Matrix3d information;
};

/// Loops from keyframe `to` to older ones.
std::vector<LaserLoop> find_loops(const std::vector<LoopKeyframe>& keyframes, std::size_t to,
                                  const LaserLoopOptions& options = {});

}  // namespace cairn
