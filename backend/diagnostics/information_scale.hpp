// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

#include "cairn/graph/graph.hpp"

namespace cairn {

class Marginals;

/// How well the information of one group of factors (one type, one kind) fits its residuals.
struct InformationScale {
  std::string_view type;
  FactorKind kind;
  std::size_t factors = 0;  ///< that took part: those with redundancy
  /// Robust (median) estimate of chi2 per degree of freedom. About 1 when the information tells the
  /// truth; far above where it claims too much, far below where it claims too little. Multiply the
  /// information by 1 / ratio to fit.
  double ratio = 1.0;
};

/// Measures every group of at least ten factors at the current values, which should be the optimum:
/// elsewhere the residuals say more about the start than about the information. With `marginals` of
/// the same values each factor is judged by its own redundancy; without, by the mean redundancy of
/// the graph. Empty where nothing is measured twice, and no entry for a group whose residuals are
/// zero (noise-free data).
std::vector<InformationScale> estimate_information_scales(const Graph& graph,
                                                          const Marginals* marginals = nullptr);

}  // namespace cairn
