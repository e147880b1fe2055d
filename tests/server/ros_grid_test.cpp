// SPDX-License-Identifier: BSD-3-Clause
#include "server/ros_grid.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cairn {
namespace {

MapTile all(TileCell cell) {
  MapTile tile;
  tile.fill(cell);
  return tile;
}

TileCell& at(MapTile& tile, int column, int row) {
  return tile[static_cast<std::size_t>(row * kTileCells + column)];
}

std::int8_t cell_of(const RosGrid::Image& image, std::uint32_t column, std::uint32_t row) {
  return image.cells[std::size_t{row} * image.width + column];
}

TEST(RosGrid, HasCellsRowByRowFromTheLowerLeft) {
  MapTile tile = all(TileCell::kUnseen);
  at(tile, 0, 0) = TileCell::kOccupied;
  at(tile, 63, 0) = TileCell::kFree;
  at(tile, 0, 63) = TileCell::kUndecided;
  RosGrid grid;
  EXPECT_TRUE(grid.is_empty());
  EXPECT_FALSE(grid.draw());
  grid.take({{{-1, 2}, tile}, {{0, 3}, all(TileCell::kFree)}}, {}, 0.05);
  const auto image = grid.draw();
  ASSERT_TRUE(image);
  EXPECT_EQ(image->width, 128u);
  EXPECT_EQ(image->height, 128u);
  EXPECT_EQ(image->resolution_m, 0.05);
  EXPECT_DOUBLE_EQ(image->origin_x_m, -3.2);
  EXPECT_DOUBLE_EQ(image->origin_y_m, 6.4);
  EXPECT_EQ(cell_of(*image, 0, 0), 100);
  EXPECT_EQ(cell_of(*image, 63, 0), 0);
  EXPECT_EQ(cell_of(*image, 0, 63), -1);  // scans contradict each other
  EXPECT_EQ(cell_of(*image, 1, 1), -1);   // unseen
  EXPECT_EQ(cell_of(*image, 64, 0), -1);  // no tile
  EXPECT_EQ(cell_of(*image, 64, 64), 0);
}

TEST(RosGrid, DrawsWhatChanged) {
  RosGrid grid;
  grid.take({{{0, 0}, all(TileCell::kFree)}, {{2, 1}, all(TileCell::kFree)}}, {}, 0.05);
  EXPECT_FALSE(grid.draw_changed());  // in nothing yet
  ASSERT_TRUE(grid.draw());
  EXPECT_FALSE(grid.has_news());
  MapTile tile = all(TileCell::kFree);
  at(tile, 5, 7) = TileCell::kOccupied;
  grid.take({{{2, 1}, tile}}, {}, 0.05);
  EXPECT_TRUE(grid.has_news());
  const auto patches = grid.draw_changed();
  ASSERT_TRUE(patches);
  ASSERT_EQ(patches->size(), 1u);
  EXPECT_EQ(patches->front().x, 128);
  EXPECT_EQ(patches->front().y, 64);
  EXPECT_EQ(patches->front().side, 64u);
  EXPECT_EQ(patches->front().cells[7 * 64 + 5], 100);
  EXPECT_FALSE(grid.has_news());
}

TEST(RosGrid, HasAnotherImageWhereTheMapGrowsOrEnds) {
  RosGrid grid;
  const std::map<TileIndex, MapTile> three{{{0, 0}, all(TileCell::kFree)},
                                           {{1, 0}, all(TileCell::kFree)},
                                           {{2, 0}, all(TileCell::kFree)}};
  grid.take(three, {}, 0.05);
  ASSERT_TRUE(grid.draw());
  grid.take({}, {{1, 0}}, 0.05);
  const auto patches = grid.draw_changed();  // its bounds are the same
  ASSERT_TRUE(patches && patches->size() == 1);
  EXPECT_THAT(patches->front().cells, testing::Each(-1));
  grid.take({}, {{2, 0}, {7, 7}}, 0.05);
  EXPECT_FALSE(grid.draw_changed());
  EXPECT_EQ(grid.draw()->width, 64u);
  grid.take({{{0, -1}, all(TileCell::kFree)}}, {}, 0.05);
  EXPECT_FALSE(grid.draw_changed());
  EXPECT_EQ(grid.draw()->height, 128u);
  grid.take(three, {}, 0.1);
  EXPECT_FALSE(grid.draw_changed());
  EXPECT_EQ(grid.draw()->resolution_m, 0.1);
  grid.take({}, {{0, 0}, {1, 0}, {2, 0}, {0, -1}}, 0.1);
  EXPECT_TRUE(grid.is_empty());
  EXPECT_FALSE(grid.draw());
}

TEST(RosGrid, IsDrawnAnewWhereMuchChanged) {
  RosGrid grid;
  std::map<TileIndex, MapTile> many;
  for (std::int32_t x = 0; x <= static_cast<std::int32_t>(RosGrid::kMostPatches); ++x)
    many.emplace(TileIndex{x, 0}, all(TileCell::kFree));
  grid.take(many, {}, 0.05);
  ASSERT_TRUE(grid.draw());
  grid.take(many, {}, 0.05);
  EXPECT_FALSE(grid.draw_changed());
  EXPECT_TRUE(grid.has_news());
}

TEST(RosGrid, HasLargerCellsWhereItIsLarge) {
  // 100 x 100 tiles are 41 million cells, a quarter of them at twice the size.
  MapTile tile = all(TileCell::kUnseen);
  at(tile, 10, 10) = TileCell::kFree;
  at(tile, 11, 11) = TileCell::kOccupied;
  at(tile, 12, 10) = TileCell::kFree;
  RosGrid grid;
  grid.take({{{0, 0}, tile}, {{99, 99}, tile}}, {}, 0.05);
  const auto image = grid.draw();
  ASSERT_TRUE(image);
  EXPECT_EQ(image->width, 3200u);
  EXPECT_EQ(image->height, 3200u);
  EXPECT_EQ(image->resolution_m, 0.1);
  EXPECT_EQ(cell_of(*image, 5, 5), 100);  // one of the four
  EXPECT_EQ(cell_of(*image, 6, 5), 0);
  EXPECT_EQ(cell_of(*image, 7, 5), -1);
  EXPECT_EQ(cell_of(*image, 99 * 32 + 5, 99 * 32 + 5), 100);
  grid.take({{{99, 99}, all(TileCell::kFree)}}, {}, 0.05);
  const auto patches = grid.draw_changed();
  ASSERT_TRUE(patches && patches->size() == 1);
  EXPECT_EQ(patches->front().x, 99 * 32);
  EXPECT_EQ(patches->front().cells.size(), 32u * 32u);
}

TEST(RosGrid, IsNotDrawnWhereNoImageHoldsIt) {
  constexpr std::int32_t kFar = (1 << 30) / kTileCells;
  RosGrid grid;
  grid.take({{{-kFar, -kFar}, all(TileCell::kFree)}, {{kFar, kFar}, all(TileCell::kFree)}}, {},
            0.05);
  EXPECT_FALSE(grid.draw());
}

}  // namespace
}  // namespace cairn
