// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cairn/maps/character_map.hpp"

namespace cairn::cli {

/// 80 x 24 where standard output is no terminal.
CharacterGrid terminal_size();

/// Shows the text (UTF-8) from the upper left corner on, without a flicker; what does not fit is
/// cut off. "\x1b[2J" clears the screen before the first.
void draw_in_place(const std::string& text);

}  // namespace cairn::cli
