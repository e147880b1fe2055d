// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/solver/problem.hpp"
#include "cairn/solver/solve_options.hpp"
#include "cairn/solver/solve_summary.hpp"

namespace cairn {

/// Minimizes the cost of `problem` with Ceres as the whole solver: same factors, losses, retraction
/// and gauge as ours, its own trust region, ordering and sparse factorization. Always runs on one
/// thread, because Ceres' sums depend on the number of threads. Gauss-Newton becomes
/// Levenberg-Marquardt with next to no damping.
///
/// `values` is the start and gets the best iterate. Fills status, stop reason, usability, chi2,
/// cost, iterations, threads and linear of `summary`; leaves the rest as it is.
void solve_with_ceres(const Problem& problem, const SolveOptions& options, Values& values,
                      SolveSummary& summary);

}  // namespace cairn
