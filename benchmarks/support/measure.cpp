// SPDX-License-Identifier: BSD-3-Clause
#include "benchmarks/support/measure.hpp"

#include <malloc.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>

namespace cairn::bench {

double Stopwatch::now() {
  static const char* const wanted = std::getenv("CAIRN_BENCH_CLOCK");
  static const clockid_t clock =
      wanted && std::strcmp(wanted, "cpu") == 0 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC;
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double median(std::span<const double> samples) {
  std::vector<double> sorted(samples.begin(), samples.end());
  // A run that failed counts as endless.
  for (double& sample : sorted) {
    if (std::isnan(sample)) sample = std::numeric_limits<double>::infinity();
  }
  std::sort(sorted.begin(), sorted.end());
  const std::size_t middle = sorted.size() / 2;
  const double upper = sorted[middle];
  return sorted.size() % 2 == 1 ? upper : 0.5 * (sorted[middle - 1] + upper);
}

std::vector<double> interleaved_medians(int rounds,
                                        std::span<const std::function<double()>> contenders) {
  std::vector<std::vector<double>> samples(contenders.size());
  for (int round = -1; round < rounds; ++round) {
    for (std::size_t k = 0; k < contenders.size(); ++k) {
      const double seconds = contenders[k]();
      if (round >= 0) samples[k].push_back(seconds);
    }
  }
  std::vector<double> medians;
  for (const auto& of_one : samples) medians.push_back(median(of_one));
  return medians;
}

void keep_freed_memory() {
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
}

double seconds_per_call(const std::function<void()>& call, double minimum_s) {
  const Stopwatch watch;
  int calls = 0;
  do {
    call();
    ++calls;
  } while (watch.seconds() < minimum_s);
  return watch.seconds() / calls;
}

double fitted_exponent(std::span<const double> x, std::span<const double> y) {
  double mean_x = 0.0, mean_y = 0.0;
  const double count = static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += std::log(x[i]) / count;
    mean_y += std::log(y[i]) / count;
  }
  double covariance = 0.0, variance = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    covariance += (std::log(x[i]) - mean_x) * (std::log(y[i]) - mean_y);
    variance += (std::log(x[i]) - mean_x) * (std::log(x[i]) - mean_x);
  }
  return covariance / variance;
}

}  // namespace cairn::bench
