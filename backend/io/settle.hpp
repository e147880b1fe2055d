// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

namespace cairn {

/// The value at which `step` stands still, or the smallest of those where it goes round in a
/// circle. Square-root information is converted with rounding; what is written is settled first, so
/// that reading and writing it again gives the same digits.
template <class Value, class Step>
Value settle(const Value& start, const Step& step) {
  constexpr int kMaxSteps = 64;  // one or two are enough but near rank loss
  std::vector<Value> seen{start};
  for (int i = 0; i < kMaxSteps; ++i) {
    const Value next = step(seen.back());
    const auto circle = std::find(seen.begin(), seen.end(), next);
    if (circle != seen.end()) return *std::min_element(circle, seen.end());
    seen.push_back(next);
  }
  return seen.back();
}

}  // namespace cairn
