// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/drawing/color.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace cairn::drawing {
namespace {

// Oklab (Ottosson 2020): a change of equal length looks like a change of equal size.
struct Oklab {
  double lightness, a, b;
};

double gamma_encoded(double linear) {
  const double x = std::clamp(linear, 0.0, 1.0);
  return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
}

Color to_srgb(const Oklab& c) {
  const double l = std::pow(c.lightness + 0.3963377774 * c.a + 0.2158037573 * c.b, 3);
  const double m = std::pow(c.lightness - 0.1055613458 * c.a - 0.0638541728 * c.b, 3);
  const double s = std::pow(c.lightness - 0.0894841775 * c.a - 1.2914855480 * c.b, 3);
  return {gamma_encoded(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          gamma_encoded(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          gamma_encoded(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

}  // namespace

Color mix(const Color& a, const Color& b, double t) {
  const auto between = [t](double x, double y) { return x + t * (y - x); };
  return {between(a.red, b.red), between(a.green, b.green), between(a.blue, b.blue),
          between(a.alpha, b.alpha)};
}

Color with_alpha(Color color, double alpha) {
  color.alpha = alpha;
  return color;
}

Color ramp_color(double t) {
  // Teal, blue, violet, crimson: chroma grows while lightness falls from 0.80 to 0.44.
  constexpr Oklab kStops[] = {{0.80, -0.090, -0.020},
                              {0.71, -0.060, -0.110},
                              {0.62, 0.060, -0.150},
                              {0.53, 0.190, -0.020},
                              {0.44, 0.150, 0.080}};
  constexpr int kLast = static_cast<int>(std::size(kStops)) - 1;
  const double position = std::clamp(t, 0.0, 1.0) * kLast;
  const int k = std::min(static_cast<int>(position), kLast - 1);
  const double w = position - k;
  const auto blend = [w](double x, double y) { return x + w * (y - x); };
  return to_srgb({blend(kStops[k].lightness, kStops[k + 1].lightness),
                  blend(kStops[k].a, kStops[k + 1].a), blend(kStops[k].b, kStops[k + 1].b)});
}

Color robot_color(std::size_t robot) {
  constexpr Color kRobots[] = {kInk,
                               {0.00, 0.45, 0.55},
                               {0.55, 0.37, 0.00},
                               {0.36, 0.24, 0.60},
                               {0.10, 0.48, 0.20},
                               {0.60, 0.20, 0.35},
                               {0.20, 0.35, 0.65},
                               {0.45, 0.45, 0.15}};
  return kRobots[robot % std::size(kRobots)];
}

}  // namespace cairn::drawing
