// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <map>

#include "cairn/maps/grid.hpp"
#include "cairn/maps/map_image.hpp"

namespace cairn {

/// What a grid says of a cell of a tile. Numbers are those on the wire.
enum class TileCell : std::uint8_t {
  kUnseen = 0,  ///< no scan says anything
  kFree = 1,
  kOccupied = 2,
  kUndecided = 3,  ///< scans contradict each other
};

/// A tile as it is read: row by row, upwards. A small fraction of the memory of its counts, and it
/// stays as it is while scans only confirm it.
using MapTile = std::array<TileCell, kTileArea>;

MapTile read_tile(const Tile<HitMissCell>& tile, MapModel model);

/// The smallest image with all cells that were seen. Errors as of draw_map().
Result<MapImage> draw_tiles(const std::map<TileIndex, MapTile>& tiles, double resolution_m);

}  // namespace cairn
