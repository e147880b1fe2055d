// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/conventions.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "cairn/geometry/information.hpp"
#include "cairn/geometry/se2.hpp"

namespace cairn {
namespace {

constexpr double kRadPerDegree = std::numbers::pi / 180.0;

std::optional<double> median(std::vector<double> numbers) {
  if (numbers.empty()) return std::nullopt;
  const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
  std::nth_element(numbers.begin(), middle, numbers.end());
  return *middle;
}

Se2 pose_of(const RawPose2& raw, double unit) { return {raw.x, raw.y, raw.angle * unit}; }

// Length of the difference between measured and predicted translation, over the measured length.
// Says nothing about the edges' angles: only the vertex it starts from turns.
std::optional<double> translation_misfit(std::span<const std::optional<RawPose2>> poses,
                                         std::span<const RawEdge2> edges, double vertex_unit) {
  std::vector<double> misfits;
  for (const RawEdge2& edge : edges) {
    const double length = std::hypot(edge.measured.x, edge.measured.y);
    if (!poses[edge.from] || !poses[edge.to] || !(length > 1e-6)) continue;
    const Se2 T_map_a = pose_of(*poses[edge.from], vertex_unit);
    const Eigen::Vector2d p_a_b =
        T_map_a.inverse() * Eigen::Vector2d(poses[edge.to]->x, poses[edge.to]->y);
    const Eigen::Vector2d measured(edge.measured.x, edge.measured.y);
    misfits.push_back((p_a_b - measured).norm() / length);
  }
  return median(std::move(misfits));
}

std::optional<double> angle_misfit(std::span<const std::optional<RawPose2>> poses,
                                   std::span<const RawEdge2> edges, double vertex_unit,
                                   double edge_unit) {
  std::vector<double> misfits;
  for (const RawEdge2& edge : edges) {
    if (!poses[edge.from] || !poses[edge.to] || edge.measured.angle == 0.0) continue;
    const double turned = (poses[edge.to]->angle - poses[edge.from]->angle) * vertex_unit;
    misfits.push_back(std::abs(wrap_angle(turned - edge.measured.angle * edge_unit)));
  }
  return median(std::move(misfits));
}

// Poses composed along a breadth-first tree of the edges; the misfit is that of the edges outside
// the tree.
std::optional<double> closure_misfit(std::size_t pose_count, std::span<const RawEdge2> edges,
                                     double edge_unit) {
  std::vector<std::vector<std::uint32_t>> edges_at(pose_count);
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    edges_at[edges[e].from].push_back(e);
    edges_at[edges[e].to].push_back(e);
  }
  std::vector<Se2> poses(pose_count);
  std::vector<bool> reached(pose_count, false), in_tree(edges.size(), false);
  std::vector<std::uint32_t> queue;
  for (std::uint32_t start = 0; start < pose_count; ++start) {
    if (reached[start]) continue;
    reached[start] = true;
    queue.assign(1, start);
    for (std::size_t head = 0; head < queue.size(); ++head) {
      for (const std::uint32_t e : edges_at[queue[head]]) {
        const bool forward = edges[e].from == queue[head];
        const std::uint32_t next = forward ? edges[e].to : edges[e].from;
        if (reached[next]) continue;
        const Se2 T_a_b = pose_of(edges[e].measured, edge_unit);
        poses[next] = poses[queue[head]] * (forward ? T_a_b : T_a_b.inverse());
        reached[next] = in_tree[e] = true;
        queue.push_back(next);
      }
    }
  }
  std::vector<double> misfits;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (in_tree[e]) continue;
    const Se2 T_a_b = poses[edges[e].from].inverse() * poses[edges[e].to];
    misfits.push_back(
        (T_a_b.translation() - Eigen::Vector2d(edges[e].measured.x, edges[e].measured.y)).norm());
  }
  return misfits.size() >= 3 ? median(std::move(misfits)) : std::nullopt;
}

// Degrees explain the numbers and radians do not.
bool prefers_degrees(double as_radians, double as_degrees) {
  constexpr double kBad =
      0.05;  // rad, or of the edge's length: a start of that quality is in radians
  constexpr double kBetter = 0.2;  // the other reading must be five times better
  return as_radians > kBad && as_degrees < kBetter * as_radians;
}

// More than a tenth of the angles is beyond half a turn, none beyond a turn in degrees.
bool magnitudes_suggest_degrees(std::span<const RawEdge2> edges) {
  std::size_t beyond = 0;
  for (const RawEdge2& edge : edges) {
    const double magnitude = std::abs(edge.measured.angle);
    if (magnitude > 360.5) return false;
    beyond += magnitude > 1.001 * std::numbers::pi;
  }
  return beyond >= 3 && 10 * beyond > edges.size();
}

void judge_edges_alone(std::size_t pose_count, std::span<const RawEdge2> edges,
                       DegreesVerdict& verdict) {
  if (!magnitudes_suggest_degrees(edges)) return;
  const auto as_radians = closure_misfit(pose_count, edges, 1.0);
  const auto as_degrees = closure_misfit(pose_count, edges, kRadPerDegree);
  if (as_radians && as_degrees) {
    verdict.misfit_as_radians = *as_radians;
    verdict.misfit_as_degrees = *as_degrees;
    verdict.edges = *as_degrees < 0.5 * *as_radians;
  } else {
    verdict.edges = true;  // no loop to ask: the magnitudes alone are unusual enough to say so
  }
}

}  // namespace

DegreesVerdict judge_angle_units(std::span<const std::optional<RawPose2>> poses,
                                 std::span<const RawEdge2> edges) {
  DegreesVerdict verdict;
  const auto in_radians = translation_misfit(poses, edges, 1.0);
  const auto in_degrees = translation_misfit(poses, edges, kRadPerDegree);
  if (!in_radians || !in_degrees) {
    judge_edges_alone(poses.size(), edges, verdict);
    return verdict;
  }
  verdict.vertices = prefers_degrees(*in_radians, *in_degrees);
  if (verdict.vertices) {
    verdict.misfit_as_radians = *in_radians;
    verdict.misfit_as_degrees = *in_degrees;
  }
  const double vertex_unit = verdict.vertices ? kRadPerDegree : 1.0;
  const auto as_radians = angle_misfit(poses, edges, vertex_unit, 1.0);
  const auto as_degrees = angle_misfit(poses, edges, vertex_unit, kRadPerDegree);
  if (as_radians && as_degrees && prefers_degrees(*as_radians, *as_degrees)) {
    verdict.edges = true;
    verdict.misfit_as_radians = *as_radians;
    verdict.misfit_as_degrees = *as_degrees;
  }
  return verdict;
}

Eigen::Matrix3d planar_information(const std::array<double, 6>& n, PlanarOrder order) {
  Eigen::Matrix3d omega;
  if (order == PlanarOrder::kRowMajor) {
    omega << n[0], n[1], n[2], n[1], n[3], n[4], n[2], n[4], n[5];
  } else {
    omega << n[0], n[1], n[4], n[1], n[2], n[5], n[4], n[5], n[3];
  }
  return omega;
}

std::array<double, 6> reorder_planar_information(const std::array<double, 6>& n, PlanarOrder to) {
  // row-major: xx xy xt yy yt tt; TORO: xx xy yy tt xt yt
  if (to == PlanarOrder::kToro) return {n[0], n[1], n[3], n[5], n[2], n[4]};
  return {n[0], n[1], n[4], n[2], n[5], n[3]};
}

namespace {

struct OrderStatistics {
  std::size_t possible = 0;     // positive semidefinite
  std::vector<double> log_det;  // of edges whose residual is not zero and both orders definite
  std::vector<double> chi2;
};

PlanarOrder other_than(PlanarOrder order) {
  return order == PlanarOrder::kToro ? PlanarOrder::kRowMajor : PlanarOrder::kToro;
}

// Log-likelihood per edge of normal residuals whose information is known up to a factor, the factor
// put in.
double log_likelihood(const OrderStatistics& statistics) {
  double log_det = 0.0;
  for (const double value : statistics.log_det) log_det += value;
  return 0.5 * log_det / static_cast<double>(statistics.log_det.size()) -
         1.5 * std::log(*median(statistics.chi2));
}

}  // namespace

OrderVerdict judge_information_order(std::span<const std::optional<RawPose2>> poses,
                                     std::span<const RawEdge2> edges, PlanarOrder given) {
  constexpr std::size_t kFewest = 3, kFewestResiduals = 20;
  constexpr double kClearlyBetter = 1.0;  // nats per edge
  OrderStatistics as_given, as_other;
  for (const RawEdge2& edge : edges) {
    const Eigen::Matrix3d omega = planar_information(edge.information, given);
    const Eigen::Matrix3d other = planar_information(edge.information, other_than(given));
    as_given.possible += is_positive_semidefinite<3>(omega);
    as_other.possible += is_positive_semidefinite<3>(other);
    const double det = omega.determinant(), det_other = other.determinant();
    if (!poses[edge.from] || !poses[edge.to] || !(det > 0.0) || !(det_other > 0.0)) continue;
    const Se2 T_a_b = pose_of(*poses[edge.from], 1.0).inverse() * pose_of(*poses[edge.to], 1.0);
    const Eigen::Vector3d e = (pose_of(edge.measured, 1.0).inverse() * T_a_b).to_vector();
    if (e.norm() < 1e-4) continue;  // rounding of the file, not a residual
    as_given.log_det.push_back(std::log(det));
    as_other.log_det.push_back(std::log(det_other));
    as_given.chi2.push_back(e.dot(omega * e));
    as_other.chi2.push_back(e.dot(other * e));
  }
  if (edges.size() >= kFewest && 2 * as_given.possible < edges.size() &&
      100 * as_other.possible >= 99 * edges.size()) {
    return OrderVerdict::kSwapped;
  }
  const bool both_possible =
      10 * as_given.possible >= 9 * edges.size() && 10 * as_other.possible >= 9 * edges.size();
  if (both_possible && as_given.chi2.size() >= kFewestResiduals &&
      log_likelihood(as_other) > log_likelihood(as_given) + kClearlyBetter) {
    return OrderVerdict::kPlausible;
  }
  return OrderVerdict::kAsGiven;
}

bool quaternions_look_w_first(std::span<const Eigen::Vector4d> edge_quaternions) {
  std::vector<double> w_last, w_first;  // rotation angles
  for (const Eigen::Vector4d& q : edge_quaternions) {
    const double norm = q.norm();
    if (!(norm > 0.0)) continue;
    w_last.push_back(2.0 * std::acos(std::min(std::abs(q[3]) / norm, 1.0)));
    w_first.push_back(2.0 * std::acos(std::min(std::abs(q[0]) / norm, 1.0)));
  }
  constexpr double kHalfTurn = 2.6, kHardly = 0.8;  // rad
  return w_last.size() >= 5 && *median(std::move(w_last)) > kHalfTurn &&
         *median(std::move(w_first)) < kHardly;
}

}  // namespace cairn
