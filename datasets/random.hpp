// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>

namespace cairn {

/// Random numbers that are the same on every machine: the standard fixes std::mt19937_64 but not
/// its distributions, and libm's logarithm differs in the last bit, so ours use comparisons and
/// exact arithmetic only.
class Random {
 public:
  /// Streams of one seed are independent: what one consumer draws does not move another.
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0);

  /// In [0, 1).
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// In [0, count); count > 0.
  std::size_t index(std::size_t count) {
    return static_cast<std::size_t>(uniform() * static_cast<double>(count));
  }
  bool chance(double probability) { return uniform() < probability; }
  /// Mean 0, standard deviation 1.
  double normal();

 private:
  bool chance_exp_minus(double x);

  std::mt19937_64 engine_;
};

}  // namespace cairn
