// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "cairn/graph/graph.hpp"
#include "cairn/solver/marginals.hpp"

namespace cairn {

/// How far a measurement is from where everything else puts its variables.
struct Innovation {
  /// Squared, in units of what both sides state: chi-square distributed with `dimension` degrees of
  /// freedom where that is honest.
  double chi2 = 0.0;
  int dimension = 0;  ///< directions in which anything else says something
  /// The sum over them of the share of what is known that is not of this measurement: how many
  /// numbers it has been checked against.
  double redundancy = 0.0;
};

/// Of a factor that is in the solution: its whitened error r has the covariance I - S, with S that
/// of the solution, so chi2 is r^T (I - S)^-1 r. `marginals` are those of the graph at its values.
/// Nothing where a variable of it is under-constrained.
std::optional<Innovation> innovation_inside(const Graph& graph, FactorRef factor,
                                            const Marginals& marginals);
/// Of one that is not, and whose variables, with their slots, are: r^T (I + S)^-1 r.
std::optional<Innovation> innovation_outside(const Graph& graph, FactorRef factor,
                                             const Marginals& marginals);

}  // namespace cairn
