// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/matching/point_map.hpp"

#include <algorithm>
#include <cmath>

namespace cairn {
namespace {

constexpr double kAlike = 0.5;         // cosine of the angle between normals
constexpr int kMostCells = 4'000'000;  // a scan that reaches far makes cells coarser, not more

}  // namespace

PointMap::PointMap(std::vector<SurfacePoint> points, double reach_m) : reach_(reach_m) {
  if (points.empty()) return;
  Eigen::Vector2d low = points.front().position, high = low;
  for (const SurfacePoint& point : points) {
    low = low.cwiseMin(point.position);
    high = high.cwiseMax(point.position);
  }
  const Eigen::Vector2d extent = high - low;
  while ((extent.x() / reach_ + 3.0) * (extent.y() / reach_ + 3.0) > kMostCells) reach_ *= 2.0;
  origin_ = low - Eigen::Vector2d::Constant(reach_);
  columns_ = static_cast<int>(extent.x() / reach_) + 3;
  rows_ = static_cast<int>(extent.y() / reach_) + 3;
  const auto cell = [&](const SurfacePoint& point) {
    return static_cast<std::size_t>(row(point.position.y()) * columns_ +
                                    column(point.position.x()));
  };
  begin_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
  for (const SurfacePoint& point : points) ++begin_[cell(point) + 1];
  for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  points_.resize(points.size());
  for (const SurfacePoint& point : points) points_[next[cell(point)]++] = point;
}

int PointMap::column(double x) const { return static_cast<int>((x - origin_.x()) / reach_); }
int PointMap::row(double y) const { return static_cast<int>((y - origin_.y()) / reach_); }

const SurfacePoint* PointMap::nearest(const Eigen::Vector2d& position,
                                      const Eigen::Vector2d& normal, double within_m) const {
  const Eigen::Vector2d in_grid = (position - origin_) / reach_;
  if (!(in_grid.x() >= 0.0) || !(in_grid.y() >= 0.0) || in_grid.x() >= columns_ ||
      in_grid.y() >= rows_)
    return nullptr;
  const double w = within_m / reach_;
  const int first_c = std::max(0, static_cast<int>(in_grid.x() - w));
  const int last_c = std::min(columns_ - 1, static_cast<int>(in_grid.x() + w));
  const int first_r = std::max(0, static_cast<int>(in_grid.y() - w));
  const int last_r = std::min(rows_ - 1, static_cast<int>(in_grid.y() + w));
  const SurfacePoint* best = nullptr;
  double least = within_m * within_m;
  for (int y = first_r; y <= last_r; ++y) {
    const std::uint32_t from = begin_[static_cast<std::size_t>(y * columns_ + first_c)];
    const std::uint32_t to = begin_[static_cast<std::size_t>(y * columns_ + last_c) + 1];
    for (std::uint32_t i = from; i < to; ++i) {
      const double squared = (points_[i].position - position).squaredNorm();
      if (squared > least) continue;
      if (points_[i].normal.isZero() || points_[i].normal.dot(normal) < kAlike * normal.norm())
        continue;
      least = squared;
      best = &points_[i];
    }
  }
  return best;
}

}  // namespace cairn
