// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <map>

#include "cairn/maps/cells.hpp"
#include "cairn/maps/grid_index.hpp"

namespace cairn {

template <class Cell>
struct Tile {
  std::array<Cell, kTileArea> cells{};  ///< row by row, upwards
  std::uint32_t scans = 0;              ///< how many say something of it

  [[nodiscard]] const Cell& at(int column, int row) const {
    return cells[static_cast<std::size_t>(row) * kTileCells + static_cast<std::size_t>(column)];
  }
  friend bool operator==(const Tile&, const Tile&) = default;
};

/// The tiles of which some scan says something, row by row. Equal grids have had the same scans, in
/// whatever order.
template <class Cell>
using Grid = std::map<TileIndex, Tile<Cell>>;

/// Adds what was traced last, or takes it away, and calls changed(TileIndex) for each tile of it.
template <class Cell, class Traced, class Changed>
void apply(const Traced& traced, Sign sign, Grid<Cell>& grid, const Changed& changed) {
  traced.for_each_tile([&](const TileIndex& index, const typename Traced::Evidence& evidence) {
    Tile<Cell>& tile = grid[index];
    tile.scans += static_cast<std::uint32_t>(sign);
    if (tile.scans == 0)
      grid.erase(index);  // all that was added to its cells has been taken away
    else
      apply(evidence, sign, tile.cells);
    changed(index);
  });
}

}  // namespace cairn
