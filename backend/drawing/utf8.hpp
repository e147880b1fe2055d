// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace cairn::drawing {

/// The text with bytes that are not UTF-8 and control characters replaced by '?': file names may
/// hold anything, and cairo refuses to draw it.
std::string printable_utf8(std::string_view text);

/// At most `characters` characters, the middle replaced by an ellipsis where there are more.
std::string shortened(std::string_view text, std::size_t characters);

}  // namespace cairn::drawing
