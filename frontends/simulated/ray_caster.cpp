// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/simulated/ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cairn/core/check.hpp"

namespace cairn {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Cells take in walls a little beside them, so that rounding loses none.
constexpr double kMarginM = 1e-6;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Whether a wall touches a box: its bounding box does, and not all corners are on one side of it.
bool touches(const Wall& wall, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  const Eigen::Vector2d least = wall.from.cwiseMin(wall.to), most = wall.from.cwiseMax(wall.to);
  if ((least.array() > high.array()).any() || (most.array() < low.array()).any()) return false;
  const Eigen::Vector2d along = wall.to - wall.from;
  double smallest = kInfinity, largest = -kInfinity;
  for (const Eigen::Vector2d& corner :
       {low, high, Eigen::Vector2d(low.x(), high.y()), Eigen::Vector2d(high.x(), low.y())}) {
    const double side = cross(along, corner - wall.from);
    smallest = std::min(smallest, side);
    largest = std::max(largest, side);
  }
  return smallest <= 0.0 && largest >= 0.0;
}

// The part of a ray within a box; empty where first > last.
std::pair<double, double> clip(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction,
                               const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  double first = 0.0, last = kInfinity;
  for (int axis = 0; axis < 2; ++axis) {
    if (direction[axis] == 0.0) {
      if (origin[axis] < low[axis] || origin[axis] > high[axis]) return {1.0, 0.0};
      continue;
    }
    const double a = (low[axis] - origin[axis]) / direction[axis];
    const double b = (high[axis] - origin[axis]) / direction[axis];
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  return {first, last};
}

}  // namespace

std::optional<double> meet(const Wall& wall, const Eigen::Vector2d& origin,
                           const Eigen::Vector2d& direction) {
  const Eigen::Vector2d along = wall.to - wall.from, to_wall = wall.from - origin;
  const double determinant = cross(direction, along);
  if (determinant == 0.0) return std::nullopt;
  const double share = cross(to_wall, direction) / determinant;
  if (!(share >= 0.0 && share <= 1.0)) return std::nullopt;
  const double distance = cross(to_wall, along) / determinant;
  return distance > 0.0 ? std::optional(distance) : std::nullopt;
}

RayCaster::RayCaster(std::vector<Wall> walls, double cell_m)
    : walls_(std::move(walls)), cell_m_(cell_m) {
  CAIRN_CHECK(cell_m > 0.0, "cells of a ray caster have a size");
  if (walls_.empty()) return;
  low_ = high_ = walls_.front().from;
  for (const Wall& wall : walls_) {
    low_ = low_.cwiseMin(wall.from).cwiseMin(wall.to);
    high_ = high_.cwiseMax(wall.from).cwiseMax(wall.to);
  }
  low_.array() -= kMarginM;
  high_.array() += kMarginM;
  columns_ = static_cast<int>((high_.x() - low_.x()) / cell_m_) + 1;
  rows_ = static_cast<int>((high_.y() - low_.y()) / cell_m_) + 1;
  cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const Eigen::Vector2d low = low_ + cell_m_ * Eigen::Vector2d(column, row);
      for (std::uint32_t i = 0; i < walls_.size(); ++i)
        if (touches(walls_[i], low.array() - kMarginM, low.array() + cell_m_ + kMarginM))
          cells_[static_cast<std::size_t>(row * columns_ + column)].push_back(i);
    }
}

std::optional<RayHit> RayCaster::cast(const Eigen::Vector2d& origin,
                                      const Eigen::Vector2d& direction, double farthest_m,
                                      double beyond_m) const {
  if (walls_.empty()) return std::nullopt;
  const auto [first, last] = clip(origin, direction, low_, high_);
  if (first > last) return std::nullopt;
  const Eigen::Vector2d start = (origin + first * direction - low_) / cell_m_;
  int cell[2] = {std::clamp(static_cast<int>(start.x()), 0, columns_ - 1),
                 std::clamp(static_cast<int>(start.y()), 0, rows_ - 1)};
  const int limit[2] = {columns_, rows_};
  int step[2];
  double exit_m[2],
      width_m[2];  // distance at which the ray leaves this column and row; between two
  for (int axis = 0; axis < 2; ++axis) {
    step[axis] = direction[axis] > 0.0 ? 1 : -1;
    width_m[axis] = direction[axis] == 0.0 ? kInfinity : cell_m_ / std::abs(direction[axis]);
    const double border = low_[axis] + cell_m_ * (cell[axis] + (step[axis] > 0 ? 1 : 0));
    exit_m[axis] = direction[axis] == 0.0 ? kInfinity : (border - origin[axis]) / direction[axis];
  }
  std::optional<RayHit> best;
  for (;;) {
    for (const std::uint32_t i : cells_[static_cast<std::size_t>(cell[1] * columns_ + cell[0])]) {
      const auto distance = meet(walls_[i], origin, direction);
      if (!distance || *distance <= beyond_m || *distance > farthest_m) continue;
      if (!best || *distance < best->distance_m ||
          (*distance == best->distance_m && i < best->wall))
        best = RayHit{*distance, i};
    }
    const int axis = exit_m[0] < exit_m[1] ? 0 : 1;
    // A wall of this cell may be met in another one first; what lies further on cannot be nearer.
    if (best && best->distance_m < exit_m[axis] - kMarginM) return best;
    if (exit_m[axis] > std::min(last, farthest_m) + kMarginM) return best;
    cell[axis] += step[axis];
    if (cell[axis] < 0 || cell[axis] >= limit[axis]) return best;
    exit_m[axis] += width_m[axis];
  }
}

}  // namespace cairn
