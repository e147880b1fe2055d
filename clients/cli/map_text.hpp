// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cairn/maps/map_image.hpp"

namespace cairn::cli {

/// A map in characters, north up, at most so many columns and rows: '#' where something in a
/// character's area is occupied, '.' where something is free, ' ' where nothing is known. A
/// character is twice as high as it is wide.
std::string picture_in_text(const MapImage& map, std::size_t columns, std::size_t rows);

}  // namespace cairn::cli
