// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <random>
#include <set>
#include <utility>

#include "cairn/maps/map_renderer.hpp"
#include "cairn/maps/ray_path.hpp"

namespace cairn::test {

using CellIndex = std::pair<std::int64_t, std::int64_t>;  ///< column, row
using SlowMap = std::map<CellIndex, HitMissCell>;

/// The referee of LaserMap: every scan anew, cell by cell, with sets. Beams up to 30 m.
inline void add_slowly(const RangeScan& scan, const Se2& T_map_body, double resolution_m,
                       SlowMap& map) {
  const Se2 T_map_laser = T_map_body * scan.T_body_laser;
  const double scale = static_cast<double>(kSubcells) / resolution_m;
  const auto to_grid = [&](const Eigen::Vector2d& p) {
    return GridPoint{std::llround(p.x() * scale), std::llround(p.y() * scale)};
  };
  std::set<CellIndex> hits, seen;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double range = scan.ranges_m[i];
    if (!std::isfinite(range) || range <= 0.0 || range >= scan.max_range_m) continue;
    const double angle = scan.first_angle_rad + static_cast<double>(i) * scan.angle_step_rad;
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    const GridPoint end = to_grid(T_map_laser * (std::min(range, 30.0) * direction));
    for_each_run(to_grid(T_map_laser.translation()), end,
                 [&](std::int64_t row, std::int64_t first, std::int64_t last) {
                   for (std::int64_t column = first; column <= last; ++column)
                     seen.insert({column, row});
                 });
    if (range <= 30.0) hits.insert({cell_of(end.x), cell_of(end.y)});
  }
  for (const CellIndex& cell : hits) ++map[cell].hits;
  for (const CellIndex& cell : seen) {
    if (!hits.contains(cell)) ++map[cell].misses;
  }
}

/// The cells of a grid of which a scan says something.
inline SlowMap known_cells(const Grid<HitMissCell>& grid) {
  SlowMap cells;
  for (const auto& [index, tile] : grid) {
    for (int row = 0; row < kTileCells; ++row) {
      for (int column = 0; column < kTileCells; ++column) {
        if (tile.at(column, row) != HitMissCell())
          cells[{std::int64_t{index.x} * kTileCells + column,
                 std::int64_t{index.y} * kTileCells + row}] = tile.at(column, row);
      }
    }
  }
  return cells;
}

/// A scan of a laser that sees half a circle, as rough as can be.
inline RangeScan random_scan(std::mt19937& random, std::size_t beams = 60) {
  std::uniform_real_distribution<float> range(-0.5F, 14.0F);
  RangeScan scan{.first_angle_rad = -1.57,
                 .angle_step_rad = 3.14 / static_cast<double>(beams),
                 .max_range_m = 12.0,
                 .T_body_laser = Se2(0.2, -0.1, 0.3),
                 .ranges_m = {}};
  for (std::size_t i = 0; i < beams; ++i) scan.ranges_m.push_back(range(random));
  return scan;
}

inline Se2 random_pose(std::mt19937& random, double spread_m) {
  std::uniform_real_distribution<double> at(-spread_m, spread_m), angle(-3.1, 3.1);
  const double x = at(random), y = at(random);
  return {x, y, angle(random)};
}

}  // namespace cairn::test
