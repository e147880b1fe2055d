// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace cairn::drawing {

/// The largest 1, 2 or 5 times a power of ten that is at most `limit`; 0 for limits that are not
/// positive.
double round_down_125(double limit);
/// The smallest one that is at least `limit`.
double round_up_125(double limit);

/// Round values in [low, high], about `count` of them.
std::vector<double> linear_ticks(double low, double high, int count);
/// Powers of ten in [low, high]; where there are fewer than two also their 2 and 5 fold.
std::vector<double> logarithmic_ticks(double low, double high);

/// "20 m", "5 km", "2 cm".
std::string format_length(double meters);
/// As short as it identifies the number at this many digits: "3549.036796", "0.01", "1.2e+06".
std::string format_number(double value, int digits);

}  // namespace cairn::drawing
