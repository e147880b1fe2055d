// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/random.hpp"

namespace cairn {
namespace {

// Seeds that differ in one bit give unrelated engines (the finalizer of splitmix64).
std::uint64_t scrambled(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

}  // namespace

Random::Random(std::uint64_t seed, std::uint64_t stream)
    : engine_(scrambled(scrambled(seed) + stream)) {}

// True with probability exp(-x), 0 <= x <= 1: a run x > u1 > u2 > ... of uniform numbers has length
// n or more with probability x^n / n!, so an even length has sum (-x)^n / n! (von Neumann 1951).
bool Random::chance_exp_minus(double x) {
  bool even = true;
  for (double u = uniform(); u < x; u = uniform()) {
    x = u;
    even = !even;
  }
  return even;
}

// Karney 2016, algorithm N: |n| = k + x with k an integer, accepted with probability exp(-(k + x)^2
// / 2) in factors.
double Random::normal() {
  for (;;) {
    int k = 0;
    while (chance_exp_minus(0.5)) ++k;  // exp(-k / 2)
    bool accepted = true;
    for (int i = 0; accepted && i < k * (k - 1); ++i)
      accepted = chance_exp_minus(0.5);  // exp(-k (k - 1) / 2)
    const double x = uniform();
    for (int i = 0; accepted && i < k; ++i) accepted = chance_exp_minus(x);  // exp(-k x)
    if (accepted && chance_exp_minus(0.5 * x * x)) return chance(0.5) ? -(k + x) : k + x;
  }
}

}  // namespace cairn
