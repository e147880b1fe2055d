// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "cairn/core/result.hpp"
#include "cairn/graph/graph.hpp"
#include "cairn/solver/solve_options.hpp"
#include "cairn/solver/solve_summary.hpp"

namespace cairn {

/// Why a loop closure was left out.
enum class GateTest {
  kPairs,     ///< with odometry between their ends, too many others contradict it
  kResidual,  ///< nothing but itself supports it where the others put its poses
};

struct LeftOutLoop {
  std::size_t factor = 0;  ///< place in Graph::factors()
  GateTest test = GateTest::kResidual;
  double chi2 = 0.0;       ///< of it, at the solution without it
  double threshold = 0.0;  ///< that it exceeds
};

struct GatedSolution {
  std::vector<LeftOutLoop> left_out;  ///< ascending by factor
  std::size_t loops = 0;              ///< there were
  /// Of the chi2 of short cycles to what their stated information says: 1 where it is honest. All
  /// thresholds are times this.
  double noise_scale = 1.0;
  SolveSummary summary;  ///< of the last solve; not usable: there is no verdict
};

/// As optimize(), with the loop closures that fit together; those that contradict the rest are
/// found and left out. Odometry and everything absolute is trusted.
///
/// Loops support each other where they tie nearby keyframes and agree (pairwise consistency:
/// Mangelson et al., "Pairwise consistent measurement set maximization", ICRA 2018, eq. 5, over
/// short stretches of odometry); of groups of such loops that contradict each other over longer
/// stretches the weaker go first. What is left is solved; where it does not fit, only the better
/// supported half is, and what agrees with that solution, by its marginal covariance, comes back:
/// supported loops first, lonely ones last.
///
/// A function of the graph. The values of `graph` move to the solution; all its factors stay.
/// kUsage where it has loops between poses in the plane and in space.
Result<GatedSolution> solve_gated(Graph& graph, const SolveOptions& options = {});

}  // namespace cairn
