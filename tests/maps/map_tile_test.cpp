// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/maps/map_tile.hpp"

#include <gtest/gtest.h>

namespace cairn {
namespace {

TEST(MapTile, TellsUndecidedCellsFromUnseenOnes) {
  Tile<HitMissCell> tile;
  tile.cells[0] = {.hits = 1, .misses = 0};
  tile.cells[1] = {.hits = 0, .misses = 1};
  tile.cells[2] = {.hits = 1, .misses = 2};
  const MapTile read = read_tile(tile, MapModel::kOccupancy);
  EXPECT_EQ(read[0], TileCell::kOccupied);
  EXPECT_EQ(read[1], TileCell::kFree);
  EXPECT_EQ(read[2], TileCell::kUndecided);
  EXPECT_EQ(read[3], TileCell::kUnseen);
}

TEST(MapTile, DrawsTheBoxOfWhatWasSeen) {
  MapTile left{}, right{};
  left[63] = TileCell::kUndecided;
  right[64 * 2 + 1] = TileCell::kOccupied;
  const Result<MapImage> image = draw_tiles({{{-1, 0}, left}, {{0, 0}, right}}, 0.5);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->width, 3u);
  EXPECT_EQ(image->height, 3u);
  EXPECT_EQ(image->T_map_image.x(), -0.5);
  EXPECT_EQ(image->at(0, 0), CellState::kUnknown);
  EXPECT_EQ(image->at(2, 2), CellState::kOccupied);
  EXPECT_FALSE(draw_tiles({{{0, 0}, MapTile{}}}, 0.5));
}

}  // namespace
}  // namespace cairn
