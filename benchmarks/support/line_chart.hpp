// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "cairn/core/result.hpp"

namespace cairn::bench {

/// A line through points (x, y), both above 0.
struct Series {
  std::string name;
  std::vector<std::pair<double, double>> points;
};

struct LineChart {
  std::string title, x_label, y_label;
  std::vector<Series> series;
};

/// Draws it on logarithmic axes into a .svg or .png file.
Result<void> draw(const LineChart& chart, const std::string& path);

}  // namespace cairn::bench
