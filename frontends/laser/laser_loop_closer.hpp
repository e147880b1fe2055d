// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "frontends/laser/drift_bound.hpp"
#include "frontends/matching/correlative.hpp"
#include "frontends/matching/point_to_line.hpp"

namespace cairn {

struct LaserLoopOptions {
  std::size_t least_apart = 20;     ///< keyframes between the ends of a loop
  double radius_m = 2.5;            ///< of candidates around the pose, beside its uncertainty
  std::size_t submap_half = 5;      ///< keyframes before and after a candidate make its submap
  std::size_t most_candidates = 2;  ///< per keyframe
  /// Poses are trusted to so many sigmas (wheels that measure too long err together, not by
  /// chance), and to the least window beside. Where that is more than the window, a match nearby
  /// proves nothing: walls of a corridor fit wherever one stands in it.
  double sigmas = 6.0;
  SearchWindow least_window{0.8, 0.8, 0.2}, window{1.5, 1.5, 0.5};
  double least_score = 0.5;
  double least_inliers = 0.6;  ///< of the points that have a line
  /// Shifted so far at most, the scan is tried whether it fits as well, but for so much of the
  /// score.
  double farthest_rival_m = 1.0, score_margin = 0.005;
  LikelihoodGrid::Options grid{};
  PointToLineOptions matching{.first_reach_m = 0.25};
  /// How far a submap is bent: of the poses in it, relative to the candidate.
  double submap_sigma_m = 0.001, submap_sigma_rad = 0.0003;
};

struct LoopKeyframe {
  Se2 T_map_laser;
  const std::vector<SurfacePoint>* points;
  /// Of the pose relative to the surfaces it was matched with.
  Eigen::Matrix3d match_information = Eigen::Matrix3d::Zero();
};

struct LaserLoop {
  std::size_t from, to;  ///< keyframes
  Se2 T_from_to;
  Eigen::Matrix3d information;  ///< of T_from_to (m, rad), positive definite
};

/// What keyframes `at` - `half` .. `at` + `half` have seen, of those before `end`, in the frame of
/// `at`.
std::vector<SurfacePoint> submap_around(const std::vector<LoopKeyframe>& keyframes, std::size_t at,
                                        std::size_t half, std::size_t end);

/// Of the pose of a scan relative to a keyframe (m, rad), where it was matched with the submap of
/// that; positive definite. `rivals`: covariance of what else it could be. `candidate`: information
/// of the keyframe's pose in its submap.
Eigen::Matrix3d loop_information(const PointToLineMatch& match, const Eigen::Matrix3d& rivals,
                                 const Eigen::Matrix3d& candidate, const LaserLoopOptions& options);

/// Where a scan lies among the keyframes of a trajectory.
struct SubmapMatch {
  std::size_t at;  ///< keyframe
  Se2 T_at_scan;
  Eigen::Matrix3d information;  ///< of T_at_scan (m, rad), positive definite
  double inliers = 0.0;         ///< share of the points that have a line
};

/// Against the keyframes around `at`, of those before `end`, within a window around a start.
/// Nothing below the options' scores.
std::optional<SubmapMatch> match_submap(const std::vector<LoopKeyframe>& keyframes, std::size_t at,
                                        std::size_t end, const std::vector<SurfacePoint>& scan,
                                        const Se2& T_at_scan, const LaserLoopOptions& options);

/// Where to look for a scan whose pose relative to a keyframe is known so well; nothing where that
/// is too badly for loops nearby.
std::optional<SearchWindow> window_nearby(const PoseSigmas& sigmas,
                                          const LaserLoopOptions& options);

/// Against those of the first `candidates` keyframes whose poses are near the scan's; submaps are
/// of keyframes before `end`. `sigmas`: of these keyframes seen from the scan; empty: not known,
/// and the whole window is searched.
std::vector<SubmapMatch> match_near(const std::vector<LoopKeyframe>& keyframes,
                                    std::size_t candidates, std::size_t end,
                                    const LoopKeyframe& scan, const LaserLoopOptions& options,
                                    std::span<const PoseSigmas> sigmas = {});

/// Loops from keyframe `to` to older ones.
std::vector<LaserLoop> find_loops(const std::vector<LoopKeyframe>& keyframes, std::size_t to,
                                  const LaserLoopOptions& options = {},
                                  std::span<const PoseSigmas> sigmas = {});

}  // namespace cairn
