// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <chrono>
#include <cstdint>

namespace cairn {

/// How long something took within the last minute or so: counts in logarithmic bins, nine percent
/// wide, by five seconds. Constant memory, whatever the rate. One thread.
class LatencyWindow {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kSlice{5};
  static constexpr std::size_t kSlices = 12;

  void add(Clock::time_point now, Clock::duration latency);

  struct Summary {
    std::uint64_t count = 0;
    /// ms; upper ends of bins. 0 where nothing was counted.
    double p50_ms = 0.0, p99_ms = 0.0, most_ms = 0.0;
  };
  [[nodiscard]] Summary summarize(Clock::time_point now) const;

 private:
  // From 1 us to an hour.
  static constexpr int kPerOctave = 8, kBins = 32 * kPerOctave;
  struct Slice {
    std::int64_t number = -1;  ///< since the clock began
    std::array<std::uint32_t, kBins> counts{};
  };
  std::array<Slice, kSlices> slices_{};
};

}  // namespace cairn
