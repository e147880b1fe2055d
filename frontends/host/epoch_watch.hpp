// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

namespace cairn {

/// Finds where frames begin anew. Stamps are labels: they may repeat, stand still, leap ahead, and
/// be up to 2 s behind the newest one (drivers and networks do that). One that is further behind
/// comes of a clock that was set, a sensor that was restarted or a log that is played again.
class EpochWatch {
 public:
  static constexpr std::int64_t kMostBackNs = 2'000'000'000;

  /// True where the frame with this stamp is the first of a new epoch; the very first is not.
  bool begins_anew(std::int64_t stamp_ns) {
    // In this order: the difference of any two stamps need not fit into 64 bits.
    const bool anew = newest_ && stamp_ns<*newest_&& static_cast<std::uint64_t>(*newest_) -
                                          static_cast<std::uint64_t>(stamp_ns)>
                                     kMostBackNs;
    newest_ = anew ? stamp_ns : std::max(newest_.value_or(stamp_ns), stamp_ns);
    return anew;
  }
  /// Of the epoch; nothing before the first frame.
  [[nodiscard]] std::optional<std::int64_t> newest() const { return newest_; }

 private:
  std::optional<std::int64_t> newest_;
};

}  // namespace cairn
