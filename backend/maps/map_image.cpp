// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/maps/map_image.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "cairn/maps/map_tile.hpp"

namespace cairn {
namespace {

constexpr std::int64_t kHit = 847, kMiss = -405;             // log(p / (1 - p)), 1/1000
constexpr std::int64_t kCertain = 3500;                      // p = 0.97: no cell is surer
constexpr std::int64_t kOccupiedFrom = 619, kFreeTo = -200;  // p = 0.65 and 0.45
constexpr std::uint64_t kMaxCells = std::uint64_t{1} << 30;

std::int64_t log_odds(const HitMissCell& cell) {
  const std::int64_t sum = kHit * cell.hits + kMiss * cell.misses;
  return std::clamp(sum, -kCertain, kCertain);
}

double to_probability(double log_odds) { return 1.0 / (1.0 + std::exp(-log_odds / 1000.0)); }

bool is_known(const HitMissCell& cell) { return cell.hits != 0 || cell.misses != 0; }

// Calls visit(column, row, cell) for the cells that were seen, in cells of the map.
template <class Visit>
void for_each_seen(const std::map<TileIndex, MapTile>& tiles, const Visit& visit) {
  for (const auto& [index, tile] : tiles) {
    for (std::size_t i = 0; i < kTileArea; ++i) {
      if (tile[i] == TileCell::kUnseen) continue;
      visit(std::int64_t{index.x} * kTileCells + static_cast<std::int64_t>(i % kTileCells),
            std::int64_t{index.y} * kTileCells + static_cast<std::int64_t>(i / kTileCells),
            tile[i]);
    }
  }
}

// The cells that were seen, as a box: its lowest cell, and the one behind its highest.
struct Box {
  std::int64_t left = INT64_MAX, bottom = INT64_MAX, right = INT64_MIN, top = INT64_MIN;
};

Box box_of(const std::map<TileIndex, MapTile>& tiles) {
  Box box;
  for_each_seen(tiles, [&](std::int64_t x, std::int64_t y, TileCell) {
    box.left = std::min(box.left, x);
    box.right = std::max(box.right, x + 1);
    box.bottom = std::min(box.bottom, y);
    box.top = std::max(box.top, y + 1);
  });
  return box;
}

}  // namespace

double probability(const HitMissCell& cell, MapModel model) {
  if (!is_known(cell)) return 0.5;
  if (model == MapModel::kOccupancy) return to_probability(static_cast<double>(log_odds(cell)));
  return static_cast<double>(cell.hits) /
         (static_cast<double>(cell.hits) + static_cast<double>(cell.misses));
}

double probability(const LogOddsCell& cell) {
  return to_probability(std::clamp<double>(cell.log_odds, -kCertain, kCertain));
}

CellState state_of(const HitMissCell& cell, MapModel model) {
  if (!is_known(cell)) return CellState::kUnknown;
  const std::int64_t hits = cell.hits, scans = hits + cell.misses;
  const bool by_odds = model == MapModel::kOccupancy;
  if (by_odds ? log_odds(cell) >= kOccupiedFrom : 3 * hits >= scans) return CellState::kOccupied;
  if (by_odds ? log_odds(cell) <= kFreeTo : 4 * hits <= scans) return CellState::kFree;
  return CellState::kUnknown;
}

MapTile read_tile(const Tile<HitMissCell>& tile, MapModel model) {
  MapTile read;
  std::transform(tile.cells.begin(), tile.cells.end(), read.begin(), [&](const HitMissCell& cell) {
    if (!is_known(cell)) return TileCell::kUnseen;
    const CellState state = state_of(cell, model);
    if (state == CellState::kUnknown) return TileCell::kUndecided;
    return state == CellState::kFree ? TileCell::kFree : TileCell::kOccupied;
  });
  return read;
}

Result<MapImage> draw_tiles(const std::map<TileIndex, MapTile>& tiles, double resolution_m) {
  const Box box = box_of(tiles);
  if (box.left > box.right)
    return Error{ErrorCode::kNotUsable, "no scan says anything of any cell: there is no map"};
  MapImage image;
  image.width = static_cast<std::size_t>(box.right - box.left);
  image.height = static_cast<std::size_t>(box.top - box.bottom);
  if (image.width > kMaxCells / image.height) {
    return Error{ErrorCode::kNotUsable,
                 "the map spreads over " + std::to_string(image.width) + " x " +
                     std::to_string(image.height) +
                     " cells, 2^30 are the most; choose larger ones with --resolution, or one "
                     "robot with --robot"};
  }
  image.resolution_m = resolution_m;
  image.T_map_image = Se2(static_cast<double>(box.left) * resolution_m,
                          static_cast<double>(box.bottom) * resolution_m, 0.0);
  image.cells.assign(image.width * image.height, CellState::kUnknown);
  for_each_seen(tiles, [&](std::int64_t x, std::int64_t y, TileCell cell) {
    if (cell == TileCell::kUndecided) return;
    image.cells[static_cast<std::size_t>(y - box.bottom) * image.width +
                static_cast<std::size_t>(x - box.left)] =
        cell == TileCell::kFree ? CellState::kFree : CellState::kOccupied;
  });
  return image;
}

Result<MapImage> draw_map(const Grid<HitMissCell>& grid, double resolution_m, MapModel model) {
  std::map<TileIndex, MapTile> tiles;
  for (const auto& [index, tile] : grid) tiles.emplace(index, read_tile(tile, model));
  return draw_tiles(tiles, resolution_m);
}

}  // namespace cairn
