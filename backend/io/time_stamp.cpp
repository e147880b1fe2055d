// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/time_stamp.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "cairn/io/record_scanner.hpp"

namespace cairn {
namespace {

constexpr std::uint64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr std::uint64_t kMaxSeconds = 9'000'000'000;  // in ns it is below 2^63

std::optional<std::uint64_t> exact_stamp_ns(std::string_view text) {
  const std::size_t point = std::min(text.find('.'), text.size());
  std::uint64_t seconds = 0, fraction_ns = 0, unit_ns = kNanosecondsPerSecond / 10;
  if (point == 0 || point > 10) return std::nullopt;
  for (const char c : text.substr(0, point)) {
    if (c < '0' || c > '9') return std::nullopt;
    seconds = 10 * seconds + static_cast<std::uint64_t>(c - '0');
  }
  bool beyond = false;  // the digit that decides about rounding has been seen
  for (const char c : text.substr(std::min(point + 1, text.size()))) {
    if (c < '0' || c > '9') return std::nullopt;
    fraction_ns += unit_ns * static_cast<std::uint64_t>(c - '0');
    if (unit_ns == 0 && !beyond) {
      fraction_ns += c >= '5';
      beyond = true;
    }
    unit_ns /= 10;
  }
  return kNanosecondsPerSecond * seconds + fraction_ns;
}

}  // namespace

std::optional<std::uint64_t> parse_stamp_ns(std::string_view seconds) {
  constexpr std::uint64_t kMost = kMaxSeconds * kNanosecondsPerSecond;
  if (const auto exact = exact_stamp_ns(seconds)) return *exact <= kMost ? exact : std::nullopt;
  double value;
  if (parse_number(seconds, value) != NumberFault::kNone) return std::nullopt;
  if (!(value >= 0.0 && value <= static_cast<double>(kMaxSeconds))) return std::nullopt;
  return static_cast<std::uint64_t>(
      std::llround(value * static_cast<double>(kNanosecondsPerSecond)));
}

std::string describe_stamp_fault(std::string_view text) {
  return "'" + quote(text) + "' is not a time stamp: seconds from 0 to 9e9 are expected";
}

std::string format_stamp(std::int64_t stamp_ns) {
  char text[40];
  const std::uint64_t size = stamp_ns < 0 ? 0 - static_cast<std::uint64_t>(stamp_ns)
                                          : static_cast<std::uint64_t>(stamp_ns);
  std::snprintf(text, sizeof text, "%s%llu.%09llu", stamp_ns < 0 ? "-" : "",
                static_cast<unsigned long long>(size / kNanosecondsPerSecond),
                static_cast<unsigned long long>(size % kNanosecondsPerSecond));
  return text;
}

}  // namespace cairn
