// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>

namespace cairn {

/// Cells along one side of a tile.
inline constexpr int kTileCells = 64;
inline constexpr std::size_t kTileArea = std::size_t{kTileCells} * kTileCells;
/// Scans that reach cells further than this from the map's origin are left out.
inline constexpr double kMaxCell = 1 << 30;

/// Which tile: it holds the cells from 64 x to 64 x + 63, and so on for y. Cell (0, 0) has its
/// lower left corner at the origin of the map.
struct TileIndex {
  std::int32_t x = 0, y = 0;

  friend auto operator<=>(const TileIndex& a, const TileIndex& b) {
    return a.y != b.y ? a.y <=> b.y : a.x <=> b.x;
  }
  friend bool operator==(const TileIndex&, const TileIndex&) = default;
};

/// A point of the grid, in 1/256 of a cell.
struct GridPoint {
  std::int64_t x = 0, y = 0;
};
inline constexpr int kSubcellBits = 8;
inline constexpr std::int64_t kSubcells = 1 << kSubcellBits;

/// The cell that a coordinate of a GridPoint is in.
constexpr std::int64_t cell_of(std::int64_t subcell) { return subcell >> kSubcellBits; }

}  // namespace cairn
