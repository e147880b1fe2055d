// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "cairn/core/result.hpp"

namespace cairn {

/// A robust loss on the squared whitened norm s = e^T Omega e of one factor.
/// rho(s) has rho(0) = 0 and rho'(0) = 1; the cost of a factor is rho(s) / 2.
class RobustLoss {
 public:
  enum class Kind : std::uint8_t { kNone, kHuber, kCauchy, kGemanMcClure, kTukey, kDcs };

  struct Value {
    double rho;     ///< rho(s)
    double weight;  ///< rho'(s): scales information in iteratively reweighted least squares
  };

  RobustLoss() = default;
  /// `width` is in standard deviations: the whitened norm where the loss starts to bend.
  RobustLoss(Kind kind, double width) : kind_(kind), width_(width) {}
  /// "huber", "cauchy:2.5", ...: names and default widths as in `cairn optimize --help`.
  static Result<RobustLoss> parse(const std::string& text);

  [[nodiscard]] Kind kind() const { return kind_; }
  [[nodiscard]] double width() const { return width_; }
  [[nodiscard]] Value evaluate(double s) const;

 private:
  Kind kind_ = Kind::kNone;
  double width_ = 1.0;
};

}  // namespace cairn
