// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/maps/map_image.hpp"

#include <algorithm>
#include <cmath>
#include <string>

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

// The cells that are known, as a box: its lowest cell, and the one behind its highest.
struct Box {
  std::int64_t left = INT64_MAX, bottom = INT64_MAX, right = INT64_MIN, top = INT64_MIN;
};

Box box_of(const Grid<HitMissCell>& grid) {
  Box box;
  for (const auto& [index, tile] : grid) {
    for (int row = 0; row < kTileCells; ++row) {
      for (int column = 0; column < kTileCells; ++column) {
        if (!is_known(tile.at(column, row))) continue;
        const std::int64_t x = std::int64_t{index.x} * kTileCells + column;
        const std::int64_t y = std::int64_t{index.y} * kTileCells + row;
        box.left = std::min(box.left, x);
        box.right = std::max(box.right, x + 1);
        box.bottom = std::min(box.bottom, y);
        box.top = std::max(box.top, y + 1);
      }
    }
  }
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

Result<MapImage> draw_map(const Grid<HitMissCell>& grid, double resolution_m, MapModel model) {
  const Box box = box_of(grid);
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
  for (const auto& [index, tile] : grid) {
    for (int row = 0; row < kTileCells; ++row) {
      for (int column = 0; column < kTileCells; ++column) {
        const HitMissCell& cell = tile.at(column, row);
        if (!is_known(cell)) continue;
        const auto x =
            static_cast<std::size_t>(index.x * std::int64_t{kTileCells} + column - box.left);
        const auto y =
            static_cast<std::size_t>(index.y * std::int64_t{kTileCells} + row - box.bottom);
        image.cells[y * image.width + x] = state_of(cell, model);
      }
    }
  }
  return image;
}

}  // namespace cairn
