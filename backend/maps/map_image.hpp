// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "cairn/core/result.hpp"
#include "cairn/geometry/se2.hpp"
#include "cairn/maps/grid.hpp"

namespace cairn {

/// What a grid says of a cell, to whoever plans a way.
enum class CellState : std::uint8_t { kUnknown, kFree, kOccupied };

/// A map as a picture of cells.
struct MapImage {
  double resolution_m = 0.05;  ///< side of a cell
  Se2 T_map_image;             ///< the lower left corner of the lower left cell
  std::size_t width = 0, height = 0;
  std::vector<CellState> cells;  ///< row by row, upwards

  [[nodiscard]] CellState at(std::size_t column, std::size_t row) const {
    return cells[row * width + column];
  }
};

/// How a grid is read.
enum class MapModel : std::uint8_t {
  kOccupancy,   ///< log odds: an echo says p = 0.7, a beam that passes p = 0.4
  kReflection,  ///< the part of the scans that had an echo: hits / (hits + misses)
};

/// The probability that a cell is occupied, or reflects; 0.5 where no scan says anything.
double probability(const HitMissCell& cell, MapModel model);
double probability(const LogOddsCell& cell);
/// Occupied from 0.65 on, free up to 0.45 (occupancy); occupied from 1/3 on, free up to 1/4
/// (reflection). In whole numbers.
CellState state_of(const HitMissCell& cell, MapModel model);

/// The smallest image with all cells of which a scan says something. kNotUsable where there are
/// none, or where it would have more than 2^30 cells.
Result<MapImage> draw_map(const Grid<HitMissCell>& grid, double resolution_m, MapModel model);

}  // namespace cairn
