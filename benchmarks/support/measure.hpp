// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace cairn::bench {

/// Wall time, s; with CAIRN_BENCH_CLOCK=cpu in the environment the processor time of this process,
/// which says more on a machine that others use too.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const { return now() - start_; }

 private:
  static double now();
  double start_ = now();
};

/// From now on memory that is freed stays with the process. Otherwise each contender pays the
/// kernel for the pages that the one before gave back, and small graphs measure little else.
void keep_freed_memory();

double median(std::span<const double> samples);

/// Runs every contender once per round, one after the other, so that a disturbance of the machine
/// hits all of them. Each returns the seconds it wants counted (not a number: it failed). One
/// untimed round comes first. Returns the median of each contender.
std::vector<double> interleaved_medians(int rounds,
                                        std::span<const std::function<double()>> contenders);

/// Seconds of one call, as an average over at least `minimum_s` of calls.
double seconds_per_call(const std::function<void()>& call, double minimum_s = 0.0);

/// Slope of log(y) over log(x) by least squares: y grows like x^slope.
double fitted_exponent(std::span<const double> x, std::span<const double> y);

}  // namespace cairn::bench
