// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/matching/scan_points.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace cairn {
namespace {

constexpr double kFlat =
    0.15;  // of a line's neighbors: their spread across over that along, at most
constexpr std::size_t kLeastNeighbors = 3;
// To either side. Close to a wall a million beams would be neighbors of each other.
constexpr std::size_t kMostNeighbors = 256;
constexpr double kRangeM = 0.01;  // noise of a range where neighbors are too few to tell

}  // namespace

std::vector<SurfacePoint> surface_points(const LaserScan& scan, const ScanPointOptions& options) {
  std::vector<SurfacePoint> points;
  std::vector<std::size_t> beams;
  points.reserve(scan.ranges_m.size());
  const double farthest = std::min(options.farthest_m, scan.max_range_m);
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double range = scan.ranges_m[i];
    if (!(range >= options.nearest_m) || !(range < farthest)) continue;
    const double angle = scan.first_angle_rad + static_cast<double>(i) * scan.angle_step_rad;
    points.push_back({.position = range * Eigen::Vector2d(std::cos(angle), std::sin(angle)),
                      .normal = {0.0, 0.0}});
    beams.push_back(i);
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Eigen::Vector2d& center = points[k].position;
    // Far echoes are further apart.
    const double spacing = center.norm() * std::abs(scan.angle_step_rad);
    const double gap = std::max(options.gap_m, 3.0 * spacing);
    const double radius = std::max(options.line_radius_m, 3.0 * spacing);
    std::size_t first = k, last = k;
    while (first > 0 && k - first < kMostNeighbors &&
           (points[first - 1].position - points[first].position).norm() < gap &&
           (points[first - 1].position - center).norm() < radius)
      --first;
    while (last + 1 < points.size() && last - k < kMostNeighbors &&
           (points[last + 1].position - points[last].position).norm() < gap &&
           (points[last + 1].position - center).norm() < radius)
      ++last;
    if (last - first + 1 < kLeastNeighbors) continue;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (std::size_t i = first; i <= last; ++i) mean += points[i].position;
    mean /= static_cast<double>(last - first + 1);
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    for (std::size_t i = first; i <= last; ++i) {
      const Eigen::Vector2d e = points[i].position - mean;
      spread += e * e.transpose();
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
    eigen.computeDirect(spread);
    if (eigen.eigenvalues()[0] > kFlat * kFlat * eigen.eigenvalues()[1]) continue;
    Eigen::Vector2d normal = eigen.eigenvectors().col(0);
    if (normal.dot(center) > 0.0) normal = -normal;
    points[k].normal = normal;
    points[k].to_line_m = normal.dot(mean - center);
    points[k].normal_variance = (eigen.eigenvalues()[0] + kRangeM * kRangeM) /
                                (static_cast<double>(last - first) * eigen.eigenvalues()[1]);
  }
  return points;
}

std::vector<SurfacePoint> moved(const Se2& T, const std::vector<SurfacePoint>& points) {
  std::vector<SurfacePoint> result;
  result.reserve(points.size());
  for (const SurfacePoint& point : points)
    result.push_back(
        {T * point.position, T.rotation() * point.normal, point.normal_variance, point.to_line_m});
  return result;
}

}  // namespace cairn
