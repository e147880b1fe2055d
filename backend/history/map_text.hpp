// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "cairn/maps/map_image.hpp"

namespace cairn {

/// A map as text that travels in an answer: a line of JSON {width, height, resolution_m, origin [x,
/// y, theta]}, then its cells row by row, upwards: '?' unknown, '.' free, '#' occupied; a number
/// before one of them repeats it.
std::string to_text(const MapImage& map);
/// The inverse. kBadInput where the text is none.
Result<MapImage> parse_map_text(std::string_view text);

}  // namespace cairn
