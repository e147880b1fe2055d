// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace cairn {

/// Seconds (0 .. 9e9) as nanoseconds. `seconds.fraction` is exact to the nanosecond, rounded half
/// up beyond it, where a double would be 0.1 us off; 1.3e9 and the like go through a double.
/// Nothing for other texts.
std::optional<std::uint64_t> parse_stamp_ns(std::string_view seconds);

/// "'x' is not a time stamp: seconds from 0 to 9e9 are expected".
std::string describe_stamp_fault(std::string_view text);

/// Nanoseconds as `seconds.nanoseconds`, with nine decimals.
std::string format_stamp(std::int64_t stamp_ns);

}  // namespace cairn
