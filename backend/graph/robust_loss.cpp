// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/graph/robust_loss.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

namespace cairn {
namespace {

struct NamedLoss {
  std::string_view name;
  RobustLoss::Kind kind;
  double default_width;
};
constexpr std::array kLosses{
    NamedLoss{"none", RobustLoss::Kind::kNone, 1.0},
    NamedLoss{"huber", RobustLoss::Kind::kHuber, 1.345},
    NamedLoss{"cauchy", RobustLoss::Kind::kCauchy, 1.0},
    NamedLoss{"geman-mcclure", RobustLoss::Kind::kGemanMcClure, 1.0},
    NamedLoss{"tukey", RobustLoss::Kind::kTukey, 4.685},
    NamedLoss{"dcs", RobustLoss::Kind::kDcs, 1.0},
};

}  // namespace

Result<RobustLoss> RobustLoss::parse(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string name = text.substr(0, colon);
  for (const NamedLoss& loss : kLosses) {
    if (loss.name != name) continue;
    double width = loss.default_width;
    if (colon != std::string::npos) {
      const char* end = text.data() + text.size();
      const auto [rest, status] = std::from_chars(text.data() + colon + 1, end, width);
      if (status != std::errc() || rest != end || !(width > 0.0) || !std::isfinite(width)) {
        return Error{ErrorCode::kUsage,
                     "loss width '" + text.substr(colon + 1) + "' is not a positive number"};
      }
    }
    return RobustLoss(loss.kind, width);
  }
  return Error{ErrorCode::kUsage, "unknown loss '" + name +
                                      "'; choose none, huber, cauchy, geman-mcclure, tukey or dcs"};
}

RobustLoss::Value RobustLoss::evaluate(double s) const {
  const double c2 = width_ * width_;
  switch (kind_) {
    case Kind::kNone:
      return {s, 1.0};
    case Kind::kHuber: {
      if (s <= c2) return {s, 1.0};
      const double norm = std::sqrt(s);
      return {2.0 * width_ * norm - c2, width_ / norm};
    }
    case Kind::kCauchy:
      return {c2 * std::log1p(s / c2), 1.0 / (1.0 + s / c2)};
    case Kind::kGemanMcClure: {
      const double d = 1.0 / (c2 + s);
      return {c2 * s * d, c2 * c2 * d * d};
    }
    case Kind::kTukey: {
      if (s >= c2) return {c2 / 3.0, 0.0};
      const double u = 1.0 - s / c2;
      return {c2 / 3.0 * (1.0 - u * u * u), u * u};
    }
    case Kind::kDcs: {  // Agarwal et al. 2013: scale = min(1, 2 phi / (phi + s)) with phi = width^2
      if (s <= c2) return {s, 1.0};
      const double scale = 2.0 * c2 / (c2 + s);
      return {c2 * (3.0 * s - c2) / (s + c2), scale * scale};
    }
  }
  return {s, 1.0};
}

}  // namespace cairn
