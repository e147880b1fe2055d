// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "cairn/graph/graph.hpp"
#include "cairn/solver/solve_options.hpp"
#include "cairn/solver/solve_summary.hpp"

namespace cairn {

/// What a few new loop closures cost those that are in already.
struct LoopTrial {
  bool passed = false;
  double increase = 0.0;   ///< of chi2 by the newcomers
  double threshold = 0.0;  ///< that it may not exceed, nor any loop's own chi2
  SolveSummary summary;
};

/// The optimum without the newcomers.
struct OptimumWithout {
  double chi2 = 0.0;
  Values values;  ///< of all variables
};

/// The gate's short way, for loops that fit a map in which everything fits: one solve with them.
/// The increase of chi2 that a loop brings is the squared Mahalanobis distance of its measurement
/// from the relative pose that everything else gives, with its marginal covariance and the
/// loop's own; that of all `newcomers` (places in factors()) is no smaller than its largest part.
/// The noise scale is that of the old loops' residuals without them: one that is false bends a
/// small map so far that everything in it seems noisy. Passes nothing that ties parts of the
/// graph together which nothing else does, and nothing where the solution is not usable: ask
/// solve_gated() then.
///
/// The values of `graph` move to the solution.
LoopTrial try_loops(Graph& graph, const std::vector<std::size_t>& newcomers,
                    const OptimumWithout& before, const SolveOptions& options = {});

}  // namespace cairn
