// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "cairn/graph/graph.hpp"
#include "cairn/solver/solve_options.hpp"
#include "cairn/solver/solve_summary.hpp"

namespace cairn {

/// Minimizes the cost of `graph` from its current values with Ceres as the whole solver: same
/// factors, losses, retraction and gauge as ours, its own trust region, ordering and sparse
/// factorization. `held[slot]` is nonzero where a variable keeps its value (fixed, gauge, or
/// under-constrained). Always runs on one thread, because Ceres' sums depend on the number of
/// threads. Gauss-Newton becomes Levenberg-Marquardt with next to no damping.
///
/// Writes the best iterate to `graph` and fills status, stop reason, usability, chi2, cost,
/// iterations and linear of `summary`; leaves the rest as it is.
void solve_with_ceres(Graph& graph, std::span<const char> held, const SolveOptions& options,
                      SolveSummary& summary);

}  // namespace cairn
