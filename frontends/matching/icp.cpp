// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/matching/icp.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "frontends/matching/match_evidence.hpp"

namespace cairn {
namespace {

constexpr std::size_t kLeastPairs = 3;
constexpr double kMedianToSigma = 1.4826;  // of a normal distribution

struct Pair {
  const SurfacePoint* point;  // of the scan
  const SurfacePoint* on;     // of the map
  double distance_m;          // of the metric; along a normal with its sign
  double weight = 1.0;
};

Result<void> check(const IcpOptions& options, const Se2& start) {
  const auto wrong = [](const std::string& what) {
    return Error{ErrorCode::kUsage, "match_icp: " + what};
  };
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  if (!positive(options.last_reach_m) || !std::isfinite(options.first_reach_m) ||
      options.first_reach_m < options.last_reach_m)
    return wrong("reach must shrink from first_reach_m to last_reach_m > 0; they are " +
                 std::to_string(options.first_reach_m) + " and " +
                 std::to_string(options.last_reach_m));
  if (!(options.keep_share > 0.0 && options.keep_share <= 1.0))
    return wrong("keep_share must be in (0, 1]; it is " + std::to_string(options.keep_share));
  if (!positive(options.sigma_m))
    return wrong("sigma_m must be positive; it is " + std::to_string(options.sigma_m));
  if (!positive(options.loss.width()))
    return wrong("the loss must have a positive width; it has " +
                 std::to_string(options.loss.width()));
  if (options.iterations < 1)
    return wrong("iterations must be 1 at least; they are " + std::to_string(options.iterations));
  if (!positive(options.least_step_m) || !positive(options.least_step_rad))
    return wrong("least_step_m and least_step_rad must be positive");
  if (!start.to_vector().allFinite()) return wrong("the start is not a finite pose");
  return {};
}

std::vector<Pair> find_pairs(const PointMap& map, const std::vector<SurfacePoint>& scan,
                             const Se2& T, double reach_m, const IcpOptions& options) {
  const bool compatible = options.pairing == IcpPairing::kClosestCompatible;
  std::vector<Pair> pairs;
  pairs.reserve(scan.size());
  for (const SurfacePoint& point : scan) {
    if (compatible && point.normal.isZero()) continue;
    const Eigen::Vector2d p = T * point.position;
    const Eigen::Vector2d normal =
        compatible ? Eigen::Vector2d(T.rotation() * point.normal) : Eigen::Vector2d(0.0, 0.0);
    const SurfacePoint* const on = map.nearest(p, normal, reach_m);
    if (on == nullptr) continue;
    const double distance = options.metric == IcpMetric::kPointToLine
                                ? on->normal.dot(p - on->position) - on->to_line_m
                                : (p - on->position).norm();
    pairs.push_back({&point, on, distance});
  }
  return pairs;
}

std::vector<double> distances_of(const std::vector<Pair>& pairs) {
  std::vector<double> distances;
  distances.reserve(pairs.size());
  for (const Pair& pair : pairs) distances.push_back(std::abs(pair.distance_m));
  return distances;
}

// Keeps the nearest share of the pairs.
void trim(std::vector<Pair>& pairs, double share) {
  if (share >= 1.0 || pairs.empty()) return;
  std::vector<double> distances = distances_of(pairs);
  const auto kept =
      static_cast<std::ptrdiff_t>(std::ceil(share * static_cast<double>(distances.size())));
  const auto last = distances.begin() + (kept - 1);
  std::nth_element(distances.begin(), last, distances.end());
  std::erase_if(pairs, [&](const Pair& pair) { return std::abs(pair.distance_m) > *last; });
}

void weigh(std::vector<Pair>& pairs, const RobustLoss& loss, double least_sigma_m) {
  if (loss.kind() == RobustLoss::Kind::kNone || pairs.empty()) return;
  std::vector<double> distances = distances_of(pairs);
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  const double sigma_m = std::max(least_sigma_m, kMedianToSigma * *middle);
  for (Pair& pair : pairs) {
    const double whitened = pair.distance_m / sigma_m;
    pair.weight = loss.evaluate(whitened * whitened).weight;
  }
}

// The pose that makes the weighted sum of squared distances smallest, in closed form.
Se2 best_point_to_point(const std::vector<Pair>& pairs) {
  double weights = 0.0;
  Eigen::Vector2d p_mean = Eigen::Vector2d::Zero(), q_mean = Eigen::Vector2d::Zero();
  for (const Pair& pair : pairs) {
    weights += pair.weight;
    p_mean += pair.weight * pair.point->position;
    q_mean += pair.weight * pair.on->position;
  }
  p_mean /= weights;
  q_mean /= weights;
  double along = 0.0, across = 0.0;
  for (const Pair& pair : pairs) {
    const Eigen::Vector2d p = pair.point->position - p_mean, q = pair.on->position - q_mean;
    along += pair.weight * p.dot(q);
    across += pair.weight * (p.x() * q.y() - p.y() * q.x());
  }
  const So2 R(std::atan2(across, along));
  return {R, q_mean - R * p_mean};
}

// One step of Gauss-Newton in the directions that surfaces fix.
Eigen::Vector3d point_to_line_step(const std::vector<Pair>& pairs, const Se2& T,
                                   const Eigen::Matrix3d& P) {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const Pair& pair : pairs) {
    const Eigen::Vector2d n = T.rotation().inverse() * pair.on->normal;
    const Eigen::Vector2d& p = pair.point->position;
    const Eigen::Vector3d J(n.x(), n.y(), n.y() * p.x() - n.x() * p.y());
    H += pair.weight * J * J.transpose();
    b += pair.weight * pair.distance_m * J;
  }
  Eigen::Matrix3d A = P.transpose() * H * P;
  A.diagonal().array() += 1e-12 * (1.0 + A.trace());
  return -A.ldlt().solve(P.transpose() * b);
}

double rms_of(const std::vector<Pair>& pairs) {
  double squares = 0.0;
  for (const Pair& pair : pairs) squares += pair.distance_m * pair.distance_m;
  return pairs.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(pairs.size()));
}

// What the surfaces fix, in the units of the tracker's matcher and with its weights.
MatchEvidence evidence_of(const std::vector<Pair>& pairs, const Se2& T, double reach_m,
                          double sigma_m) {
  MatchEvidence evidence(std::max(2.0 * sigma_m, 0.33 * reach_m));
  for (const Pair& pair : pairs) {
    const double off = pair.on->normal.dot(T * pair.point->position - pair.on->position);
    evidence.add(*pair.point, *pair.on, T, off - pair.on->to_line_m);
  }
  return evidence;
}

}  // namespace

std::string_view name_of(IcpStop stop) {
  switch (stop) {
    case IcpStop::kConverged:
      return "converged";
    case IcpStop::kIterations:
      return "iterations used up";
    case IcpStop::kTooFewPairs:
      break;
  }
  return "too few pairs";
}

Result<IcpMatch> match_icp(const PointMap& map, const std::vector<SurfacePoint>& scan,
                           const Se2& start, const IcpOptions& options) {
  if (const Result<void> sound = check(options, start); !sound) return sound.error();
  IcpMatch match;
  match.T_map_scan = start;
  const double last_reach = std::min(options.last_reach_m, map.reach_m());
  double reach = std::min(options.first_reach_m, map.reach_m());
  for (match.iterations = 0; match.iterations < options.iterations;) {
    const Se2 T = match.T_map_scan;
    std::vector<Pair> pairs = find_pairs(map, scan, T, reach, options);
    match.pairs = static_cast<int>(pairs.size());
    match.inliers =
        static_cast<int>(std::count_if(pairs.begin(), pairs.end(), [&](const Pair& pair) {
          return std::abs(pair.distance_m) <= 3.0 * options.sigma_m;
        }));
    trim(pairs, options.keep_share);
    weigh(pairs, options.loss, options.sigma_m);
    std::erase_if(pairs, [](const Pair& pair) { return pair.weight <= 0.0; });
    match.rms_m = rms_of(pairs);
    const MatchEvidence evidence = evidence_of(pairs, T, reach, options.sigma_m);
    const MatchEvidence::Seen seen = evidence.seen();
    match.information = evidence.information(seen);
    match.free = seen.free;
    match.free_direction = seen.free_direction;
    if (pairs.size() < kLeastPairs) {
      match.stop = IcpStop::kTooFewPairs;
      return match;
    }
    const Eigen::Vector3d dx = options.metric == IcpMetric::kPointToLine
                                   ? point_to_line_step(pairs, T, seen.projection)
                                   : (T.inverse() * best_point_to_point(pairs)).log();
    if (!dx.allFinite()) {
      match.stop = IcpStop::kTooFewPairs;
      return match;
    }
    match.T_map_scan = T.retract(dx);
    ++match.iterations;
    const bool small =
        dx.head<2>().norm() < options.least_step_m && std::abs(dx.z()) < options.least_step_rad;
    if (small && reach <= last_reach) {
      match.stop = IcpStop::kConverged;
      return match;
    }
    reach = small ? last_reach : std::max(last_reach, 0.7 * reach);
  }
  match.stop = IcpStop::kIterations;
  return match;
}

}  // namespace cairn
