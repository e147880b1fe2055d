// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/graph/graph.hpp"
#include "cairn/solver/solve_options.hpp"
#include "cairn/solver/solve_summary.hpp"

namespace cairn {

/// Moves the variables of `graph` to a local minimum of the cost, 1/2 sum rho(e^T Omega e),
/// starting from options.init. Each component without a fixed variable or absolute factor is held
/// at the pose with its smallest id. Under-constrained variables keep their value and are named.
/// `graph` always gets the best iterate, never the last; look at summary.usable() before you use
/// it. One thread may call this per graph.
SolveSummary optimize(Graph& graph, const SolveOptions& options = {});

/// False for a back-end that this build leaves out (CAIRN_WITH_CERES=OFF); optimize() then takes
/// the default and says so in summary.linear.
bool is_available(LinearBackend backend);

/// chi2 of the graph at its current values, in the given chart.
double compute_chi2(const Graph& graph, ErrorChart chart = ErrorChart::kG2o);

}  // namespace cairn
