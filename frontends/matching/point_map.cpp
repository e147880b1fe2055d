// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/matching/point_map.hpp"

#include <algorithm>
#include <cmath>

namespace cairn {
namespace {

constexpr double kAlike = 0.5;  // cosine of the angle between normals
constexpr double kCellsInReach = 4.0;
constexpr int kMostCells = 4'000'000;  // a scan that reaches far makes cells coarser, not more

}  // namespace

PointMap::PointMap(std::vector<SurfacePoint> points, double reach_m)
    : reach_(reach_m), cell_(reach_m / kCellsInReach) {
  if (points.empty()) return;
  Eigen::Vector2d low = points.front().position, high = low;
  for (const SurfacePoint& point : points) {
    low = low.cwiseMin(point.position);
    high = high.cwiseMax(point.position);
  }
  const Eigen::Vector2d extent = high - low;
  while ((extent.x() / cell_ + 1.0) * (extent.y() / cell_ + 1.0) > kMostCells) cell_ *= 2.0;
  origin_ = low;
  columns_ = static_cast<int>(extent.x() / cell_) + 1;
  rows_ = static_cast<int>(extent.y() / cell_) + 1;
  const auto cell = [&](const SurfacePoint& point) {
    const Eigen::Vector2d in_grid = (point.position - origin_) / cell_;
    return static_cast<std::size_t>(std::min(static_cast<int>(in_grid.y()), rows_ - 1) * columns_ +
                                    std::min(static_cast<int>(in_grid.x()), columns_ - 1));
  };
  begin_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
  for (const SurfacePoint& point : points) ++begin_[cell(point) + 1];
  for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  points_.resize(points.size());
  for (const SurfacePoint& point : points) points_[next[cell(point)]++] = point;
}

// Rows from the middle outwards, each as wide as something nearer may still be.
const SurfacePoint* PointMap::nearest(const Eigen::Vector2d& position,
                                      const Eigen::Vector2d& normal, double within_m) const {
  const Eigen::Vector2d at = (position - origin_) / cell_;  // in cells
  const double within = within_m / cell_;
  if (!(at.x() + within >= 0.0) || !(at.y() + within >= 0.0) || !(at.x() - within < columns_) ||
      !(at.y() - within < rows_))
    return nullptr;
  const double alike = kAlike * normal.norm();
  const SurfacePoint* best = nullptr;
  double least = within_m * within_m;
  const auto is_over = [&](int row) {
    if (row < 0 || row >= rows_) return true;
    const double aside = cell_ * std::max({0.0, row - at.y(), at.y() - (row + 1)});
    const double left = least - aside * aside;
    if (left < 0.0) return true;
    const double wide = std::sqrt(left) / cell_;
    const int first = std::max(0, static_cast<int>(at.x() - wide));
    const int last = std::min(columns_ - 1, static_cast<int>(at.x() + wide));
    if (at.x() + wide < 0.0 || first > last) return false;
    const std::uint32_t from = begin_[static_cast<std::size_t>(row * columns_ + first)];
    const std::uint32_t to = begin_[static_cast<std::size_t>(row * columns_ + last) + 1];
    for (std::uint32_t i = from; i < to; ++i) {
      const double squared = (points_[i].position - position).squaredNorm();
      if (squared > least) continue;
      if (points_[i].normal.isZero() || points_[i].normal.dot(normal) < alike) continue;
      least = squared;
      best = &points_[i];
    }
    return false;
  };
  const int middle = std::clamp(static_cast<int>(at.y()), 0, rows_ - 1);
  for (int row = middle; !is_over(row);) ++row;
  for (int row = middle - 1; !is_over(row);) --row;
  return best;
}

}  // namespace cairn
