// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/maps/character_map.hpp"

#include <algorithm>

namespace cairn {
namespace {

constexpr std::size_t divide_up(std::size_t a, std::size_t b) { return (a + b - 1) / b; }

/// What the cells of each square say together: occupied before free before unknown.
struct Squares {
  std::size_t width = 0, height = 0;
  std::vector<CellState> states;  ///< row by row, upwards

  Squares(const MapImage& map, std::size_t side)
      : width(divide_up(map.width, side)),
        height(divide_up(map.height, side)),
        states(width * height, CellState::kUnknown) {
    for (std::size_t row = 0; row < map.height; ++row) {
      for (std::size_t column = 0; column < map.width; ++column) {
        CellState& state = states[row / side * width + column / side];
        state = std::max(state, map.at(column, row));
      }
    }
  }

  [[nodiscard]] CellState at(std::size_t column, std::size_t row) const {
    return row < height ? states[row * width + column] : CellState::kUnknown;
  }
};

const char* character(CellState upper, CellState lower) {
  const bool wall_above = upper == CellState::kOccupied, wall_below = lower == CellState::kOccupied;
  if (wall_above && wall_below) return "█";
  if (wall_above) return "▀";
  if (wall_below) return "▄";
  return upper == CellState::kFree || lower == CellState::kFree ? "·" : " ";
}

}  // namespace

std::string draw_with_characters(const MapImage& map, CharacterGrid size) {
  if (map.cells.empty() || size.columns == 0 || size.rows == 0) return {};
  const std::size_t side = std::max<std::size_t>(
      {1, divide_up(map.width, size.columns), divide_up(map.height, 2 * size.rows)});
  const Squares squares(map, side);
  std::string text;
  for (std::size_t line = divide_up(squares.height, 2); line-- > 0;) {
    for (std::size_t column = 0; column < squares.width; ++column)
      text += character(squares.at(column, 2 * line + 1), squares.at(column, 2 * line));
    text += '\n';
  }
  return text;
}

}  // namespace cairn
