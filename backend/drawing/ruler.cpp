// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/drawing/ruler.hpp"

#include <cmath>
#include <cstdio>

namespace cairn::drawing {
namespace {

constexpr double kRounding = 1e-9;

}  // namespace

double round_down_125(double limit) {
  if (!(limit > 0.0) || !std::isfinite(limit)) return 0.0;
  const double decade = std::pow(10.0, std::floor(std::log10(limit) + kRounding));
  const double leading = limit / decade * (1 + kRounding);
  return decade * (leading >= 5.0 ? 5.0 : leading >= 2.0 ? 2.0 : 1.0);
}

double round_up_125(double limit) {
  const double below = round_down_125(limit);
  if (below == 0.0 || limit <= below * (1 + kRounding)) return below;
  const double leading = below / std::pow(10.0, std::floor(std::log10(below) + kRounding));
  return below * (leading > 1.5 && leading < 2.5 ? 2.5 : 2.0);
}

std::vector<double> linear_ticks(double low, double high, int count) {
  std::vector<double> ticks;
  const double step = round_up_125((high - low) / count);
  if (step == 0.0) return ticks;
  const double slack = kRounding * (high - low);
  for (double k = std::ceil((low - slack) / step); k * step <= high + slack; ++k)
    ticks.push_back(k * step + 0.0);  // makes -0 a 0
  return ticks;
}

std::vector<double> logarithmic_ticks(double low, double high) {
  std::vector<double> decades, all;
  const int first = static_cast<int>(std::floor(std::log10(low)));
  const int last = static_cast<int>(std::ceil(std::log10(high)));
  for (int exponent = first; exponent <= last; ++exponent) {
    for (const double leading : {1.0, 2.0, 5.0}) {
      const double tick = leading * std::pow(10.0, exponent);
      if (tick < low * (1 - kRounding) || tick > high * (1 + kRounding)) continue;
      all.push_back(tick);
      if (leading == 1.0) decades.push_back(tick);
    }
  }
  return decades.size() >= 3 ? decades : all;
}

std::string format_length(double meters) {
  if (meters >= 1000.0) return format_number(meters / 1000.0, 4) + " km";
  if (meters >= 1.0 || meters == 0.0) return format_number(meters, 4) + " m";
  if (meters >= 0.01) return format_number(meters * 100.0, 4) + " cm";
  return format_number(meters * 1000.0, 4) + " mm";
}

std::string format_number(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

}  // namespace cairn::drawing
