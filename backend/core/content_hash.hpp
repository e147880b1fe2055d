// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace cairn {

/// SHA-256: what bytes are called when their content is their name.
using ContentHash = std::array<std::uint8_t, 32>;

ContentHash content_hash(std::string_view bytes);
/// 64 hexadecimal digits.
std::string to_string(const ContentHash& hash);

}  // namespace cairn
