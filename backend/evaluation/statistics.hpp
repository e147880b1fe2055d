// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

namespace cairn {

/// Of a sample of errors; `standard_deviation` divides by the count. NaN for an empty sample.
struct Statistics {
  double mean, standard_deviation, rmse, median, min, max;
};

Statistics compute_statistics(std::span<const double> errors);

}  // namespace cairn
