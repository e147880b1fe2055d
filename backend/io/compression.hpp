// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "cairn/core/result.hpp"

namespace cairn {

enum class Compression { kNone, kGzip, kBzip2 };

/// By the first bytes of a file's content.
Compression recognize_compression(std::string_view bytes);
/// By the end of a file's name: .gz, .bz2.
Compression compression_for(std::string_view path);

/// All members of a .gz or .bz2 file, one after the other. `name` stands for the file in messages.
/// Refused when the text would be longer than `limit` bytes, and when the file is damaged or cut
/// short.
Result<std::string> decompress(std::string_view bytes, Compression compression,
                               const std::string& name, std::size_t limit);

/// One .gz or .bz2 member (or a copy), at the usual level; no time stamp, so equal text gives equal
/// bytes.
std::string compress(std::string_view text, Compression compression);

}  // namespace cairn
