// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/maps/character_map.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace cairn {
namespace {

// Rows from above; '#' is occupied, '.' free.
MapImage image(const std::vector<std::string>& rows) {
  MapImage map;
  map.width = rows[0].size();
  map.height = rows.size();
  for (auto row = rows.rbegin(); row != rows.rend(); ++row)
    for (const char cell : *row)
      map.cells.push_back(cell == '#'   ? CellState::kOccupied
                          : cell == '.' ? CellState::kFree
                                        : CellState::kUnknown);
  return map;
}

TEST(CharacterMap, DrawsTwoCellsOneAboveTheOtherPerCharacter) {
  EXPECT_EQ(draw_with_characters(image({"#.# ",  //
                                        "##. "}),
                                 {80, 24}),
            "█▄▀ \n");
  EXPECT_EQ(draw_with_characters(image({" . ",  //
                                        "#..",  //
                                        " .#"}),
                                 {80, 24}),
            " · \n▀·▄\n");
}

TEST(CharacterMap, MakesALargeMapFit) {
  MapImage map;
  map.width = 1000;
  map.height = 300;
  map.cells.assign(map.width * map.height, CellState::kFree);
  for (std::size_t row = 0; row < map.height; ++row)
    map.cells[row * map.width] = CellState::kOccupied;
  std::istringstream lines(draw_with_characters(map, {40, 10}));
  std::string line;
  std::size_t count = 0;
  for (; std::getline(lines, line); ++count) EXPECT_TRUE(line.starts_with("█·"));
  EXPECT_EQ(count, 6U);  // squares of 25 cells: 40 x 12
}

TEST(CharacterMap, DrawsNothingOfNothing) { EXPECT_EQ(draw_with_characters({}, {80, 24}), ""); }

}  // namespace
}  // namespace cairn
