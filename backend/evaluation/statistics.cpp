// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/evaluation/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace cairn {

Statistics compute_statistics(std::span<const double> errors) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  if (errors.empty()) return {kNan, kNan, kNan, kNan, kNan, kNan};
  const auto count = static_cast<double>(errors.size());
  double sum = 0.0, sum_of_squares = 0.0;
  for (const double error : errors) sum += error, sum_of_squares += error * error;
  const double mean = sum / count;
  double variance = 0.0;
  for (const double error : errors) variance += (error - mean) * (error - mean) / count;

  std::vector<double> sorted(errors.begin(), errors.end());
  std::sort(sorted.begin(), sorted.end());
  const std::size_t middle = sorted.size() / 2;
  const double median =
      sorted.size() % 2 ? sorted[middle] : 0.5 * (sorted[middle - 1] + sorted[middle]);
  return {mean,   std::sqrt(variance), std::sqrt(sum_of_squares / count),
          median, sorted.front(),      sorted.back()};
}

}  // namespace cairn
