// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/recorder.hpp"

#include <algorithm>

namespace cairn {

// Exactly `count` of `total`, each choice equally likely, in order (Knuth, TAOCP 2, 3.4.2,
// algorithm S).
std::vector<bool> choose(std::size_t count, std::size_t total, Random& random) {
  std::vector<bool> chosen(total, false);
  for (std::size_t i = 0; i < total && count > 0; ++i) {
    if (random.index(total - i) < count) chosen[i] = true, --count;
  }
  return chosen;
}

// The earlier pose that a false closure takes for loop.from: far from both in time where there is
// such a pose.
std::uint32_t mistaken_pose(const LoopPair& loop, Random& random) {
  const std::uint32_t gap = std::min<std::uint32_t>(loop.to / 5, 50);
  const auto distance = [](std::uint32_t a, std::uint32_t b) { return a < b ? b - a : a - b; };
  for (int attempt = 0;; ++attempt) {
    const auto other = static_cast<std::uint32_t>(random.index(loop.to - 1));
    const std::uint32_t wanted = attempt < 100 ? gap : 1;
    if (distance(other, loop.from) >= wanted && loop.to - other >= wanted) return other;
  }
}

}  // namespace cairn
