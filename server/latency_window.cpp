// SPDX-License-Identifier: BSD-3-Clause
#include "server/latency_window.hpp"

#include <algorithm>
#include <cmath>

namespace cairn {
namespace {

std::int64_t slice_at(LatencyWindow::Clock::time_point now) {
  return now.time_since_epoch() / LatencyWindow::kSlice;
}

}  // namespace

void LatencyWindow::add(Clock::time_point now, Clock::duration latency) {
  const std::int64_t number = slice_at(now);
  Slice& slice = slices_[static_cast<std::size_t>(number) % kSlices];
  if (slice.number != number) slice = {number, {}};
  const double us = std::chrono::duration<double, std::micro>(latency).count();
  const int bin = us <= 1.0 ? 0 : static_cast<int>(std::log2(us) * kPerOctave) + 1;
  ++slice.counts[static_cast<std::size_t>(std::min(bin, kBins - 1))];
}

LatencyWindow::Summary LatencyWindow::summarize(Clock::time_point now) const {
  const std::int64_t newest = slice_at(now);
  std::array<std::uint64_t, kBins> counts{};
  Summary summary;
  for (const Slice& slice : slices_) {
    if (slice.number < 0 || slice.number + static_cast<std::int64_t>(kSlices) <= newest) continue;
    for (std::size_t bin = 0; bin < counts.size(); ++bin) counts[bin] += slice.counts[bin];
  }
  for (const std::uint64_t count : counts) summary.count += count;
  std::uint64_t below = 0;
  const auto rank = [&](double part) {
    return static_cast<std::uint64_t>(std::ceil(part * static_cast<double>(summary.count)));
  };
  for (std::size_t bin = 0; bin < counts.size(); ++bin) {
    if (counts[bin] == 0) continue;
    const double end_ms = 1e-3 * std::exp2(static_cast<double>(bin) / kPerOctave);
    if (below < rank(0.5)) summary.p50_ms = end_ms;
    if (below < rank(0.99)) summary.p99_ms = end_ms;
    summary.most_ms = end_ms;
    below += counts[bin];
  }
  return summary;
}

}  // namespace cairn
