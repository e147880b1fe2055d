// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/map_text.hpp"

#include <algorithm>
#include <vector>

namespace cairn::cli {

std::string picture_in_text(const MapImage& map, std::size_t columns, std::size_t rows) {
  // Cells along the width of a character.
  const std::size_t wide = std::max({std::size_t{1}, (map.width + columns - 1) / columns,
                                     (map.height + 2 * rows - 1) / (2 * rows)});
  const std::size_t high = 2 * wide;
  std::vector<std::string> lines((map.height + high - 1) / high,
                                 std::string((map.width + wide - 1) / wide, ' '));
  for (std::size_t row = 0; row < map.height; ++row) {
    for (std::size_t column = 0; column < map.width; ++column) {
      char& character = lines[row / high][column / wide];
      const CellState cell = map.at(column, row);
      if (cell == CellState::kOccupied) character = '#';
      if (cell == CellState::kFree && character == ' ') character = '.';
    }
  }
  std::string text;
  for (auto line = lines.rbegin(); line != lines.rend(); ++line) {
    line->erase(line->find_last_not_of(' ') + 1);
    text += *line + '\n';
  }
  return text;
}

}  // namespace cairn::cli
