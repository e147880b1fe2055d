// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace cairn {

/// How much may be computed, counted in multiplications and not in time: the same input ends at the
/// same place on every machine, and however busy it is. One thread.
class WorkBudget {
 public:
  explicit WorkBudget(double multiplications) : left_(multiplications) {}

  void spend(double multiplications) { left_ -= multiplications; }
  [[nodiscard]] bool spent() const { return left_ < 0.0; }

 private:
  double left_;
};

}  // namespace cairn
