// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/linear/elimination.hpp"
#include "cairn/solver/problem.hpp"
#include "cairn/solver/solve_summary.hpp"

namespace cairn {

/// Replaces the estimates of what is not held by the start that options.init asks for: as they are
/// (file), chained along odometry or a breadth-first spanning tree, or chordal. Landmarks follow
/// from their first sighting where one sighting tells. kAuto tries the candidates and keeps the one
/// with the lowest cost; the expensive ones are not tried when a cheap one already explains the
/// measurements (chi2 at most the degrees of freedom). Fills init_chosen and init_candidates.
void initialize(const Problem& problem, const Elimination& elimination, const SolveOptions& options,
                Values& values, SolveSummary& summary);

}  // namespace cairn
