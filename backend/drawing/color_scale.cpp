// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/drawing/color_scale.hpp"

#include <algorithm>
#include <cmath>

#include "cairn/drawing/ruler.hpp"

namespace cairn::drawing {
namespace {

constexpr double kLargestShown = 0.995;
constexpr double kSmallestShown = 0.02;
constexpr double kDwarfed = 20.0;  // from here on a linear scale would show one colour only
constexpr double kDecades = 1e4;   // at most, on a logarithmic scale

double quantile(std::vector<double>& values, double q) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

double ColorScale::position(double value) const {
  if (!(value > low)) return 0.0;
  const double t =
      logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
  return std::min(t, 1.0);
}

int ColorScale::bin(double value) const {
  return std::min(static_cast<int>(position(value) * kBins), kBins - 1);
}

Color ColorScale::bin_color(int bin) { return ramp_color((bin + 0.5) / kBins); }

std::vector<double> ColorScale::ticks() const {
  return logarithmic ? logarithmic_ticks(low, high) : linear_ticks(low, high, 5);
}

ColorScale choose_color_scale(std::vector<double> values) {
  constexpr double kAlmostZero =
      1e-6;  // noise-free graphs have residuals of rounding errors: all calm
  if (values.empty()) return {};
  const double median = quantile(values, 0.5);
  const double largest = *std::max_element(values.begin(), values.end());
  const double top = std::max(quantile(values, kLargestShown), kAlmostZero);
  const double step = round_down_125(top / 4);
  ColorScale scale{.low = 0.0, .high = step * std::ceil(top / step * (1 - 1e-9))};
  scale.clipped = largest > scale.high;
  if (top > kDwarfed * median) {
    scale.logarithmic = true;
    scale.low = round_down_125(std::max(quantile(values, kSmallestShown), scale.high / kDecades));
  }
  return scale;
}

}  // namespace cairn::drawing
