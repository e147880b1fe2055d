// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string_view>

#include "cairn/core/result.hpp"
#include "cairn/graph/robust_loss.hpp"
#include "frontends/matching/point_map.hpp"

namespace cairn {

/// The distance that is made small.
enum class IcpMetric : std::uint8_t {
  kPointToPoint,  ///< closed form in each step (Besl and McKay, PAMI 1992; Arun, PAMI 1987)
  kPointToLine    ///< along the neighbor's normal (Chen and Medioni 1992; Censi, ICRA 2008)
};

/// Which point of the map belongs to a point of the scan.
enum class IcpPairing : std::uint8_t {
  kClosest,
  kClosestCompatible  ///< normals within 60 deg (Godin et al. 1994; Pulli 1999)
};

struct IcpOptions {
  IcpMetric metric = IcpMetric::kPointToLine;
  IcpPairing pairing = IcpPairing::kClosestCompatible;
  /// Of pairs. Shrinks by 0.7 from step to step, and is never more than the map was made for.
  double first_reach_m = 0.5, last_reach_m = 0.5;
  /// Of the pairs, those with the smallest distances: trimmed ICP (Chetverikov et al., ICPR 2002)
  double keep_share = 1.0;
  /// Of distances (iteratively reweighted). Its standard deviation is 1.48 medians of the distances
  /// that are kept, at least sigma_m, so that it shrinks with them.
  RobustLoss loss{};
  double sigma_m = 0.02;  ///< of a distance; inliers are within three
  int iterations = 100;
  double least_step_m = 1e-5, least_step_rad = 1e-5;  ///< below both it has converged
};

enum class IcpStop : std::uint8_t {
  kConverged,
  kIterations,   ///< all of them done, and still moving
  kTooFewPairs,  ///< fewer than 3 with a weight (empty map or scan, nothing within reach), or not
                 ///< finite
};
std::string_view name_of(IcpStop stop);

/// Pairs, distances and information are those of the last step, before it moved.
struct IcpMatch {
  Se2 T_map_scan;  ///< after kTooFewPairs: as far as it came, at first the start
  IcpStop stop = IcpStop::kTooFewPairs;
  int iterations = 0;  ///< steps made
  int pairs = 0;       ///< within reach
  int inliers = 0;     ///< of these, within three sigma_m
  double rms_m = 0.0;  ///< of the distances that were kept and have a weight
  /// Of surfaces, as the tracker's matcher measures it (match_evidence), whatever the metric;
  /// d in T Exp(d) (m, rad). Zero in free directions.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  int free = 3;  ///< directions that no surface fixes. Point to line does not move in them
  std::optional<Eigen::Vector3d> free_direction{};  ///< the freest, in the frame of the scan
};

/// Moves a scan onto a map from a start nearby by iterated closest points, in the variant that
/// `options` choose. Points of the map without a normal are left out, and those of the scan where
/// the pairing or the metric needs them. An error (kUsage) where options or the start make no
/// sense. Any thread.
Result<IcpMatch> match_icp(const PointMap& map, const std::vector<SurfacePoint>& scan,
                           const Se2& T_map_scan, const IcpOptions& options = {});

}  // namespace cairn
