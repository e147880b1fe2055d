// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/linear/linear_solver.hpp"
#include "cairn/solver/normal_equations.hpp"
#include "cairn/solver/solve_summary.hpp"

namespace cairn {

/// Where an iterative minimization ended.
struct MinimizerResult {
  StopReason reason = StopReason::kNotFinite;
  RangeCost initial, final;
  /// What an undamped step from the final values would still gain, in chi2; infinite where it
  /// cannot be computed.
  double predicted_chi2_decrease = 0.0;
  /// The first matrix could not be told from a singular one: nothing was moved, see
  /// find_free_directions().
  bool looks_singular = false;
  std::vector<IterationReport> iterations;
};

/// Minimizes the cost over the unknowns of `equations`, from `values`, which get the best iterate.
/// With `check_rank` it stops before the first step where the matrix looks singular.
/// `linear` is analyzed for the pattern of `equations`, which are linearized at `values` with the
/// cost `initial`.
MinimizerResult minimize(NormalEquations& equations, LinearSolver& linear,
                         const SolveOptions& options, ThreadPool& pool, Values& values,
                         RangeCost initial, bool check_rank);

}  // namespace cairn
