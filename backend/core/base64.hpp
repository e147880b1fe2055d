// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "cairn/core/result.hpp"

namespace cairn {

/// Bytes as text (RFC 4648, padded, one line).
std::string to_base64(std::string_view bytes);
/// The inverse. kBadInput for every text that to_base64() cannot have made.
Result<std::string> from_base64(std::string_view text);

}  // namespace cairn
