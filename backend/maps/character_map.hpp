// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cairn/maps/map_image.hpp"

namespace cairn {

/// Room for a drawing: characters in a line, lines.
struct CharacterGrid {
  std::size_t columns = 80, rows = 24;
};

/// The map in block characters, as large as fits, y up: a character stands for two squares of
/// cells, one above the other. Full where a cell of the square is occupied, a dot where one is
/// free, blank where nothing is known. Lines end with '\n'. Empty for a map without cells.
std::string draw_with_characters(const MapImage& map, CharacterGrid size);

}  // namespace cairn
