// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>
#include <vector>

#include "cairn/graph/graph.hpp"
#include "cairn/solver/solve_options.hpp"
#include "cairn/solver/solve_summary.hpp"

namespace cairn {

/// Why a loop closure was left out.
enum class GateTest {
  kPairs,     ///< with odometry between their ends, too many others contradict it
  kResidual,  ///< nothing but itself supports it where the others put its poses
  kTooFew,    ///< it would tie together what nothing else does, and too few others say the same
};
/// "contradicts other loops", "does not fit the map", "too few loops tie these maps together".
std::string_view to_string(GateTest test);

struct LeftOutLoop {
  std::size_t factor = 0;  ///< place in Graph::factors()
  GateTest test = GateTest::kResidual;
  /// Its chi2 at the solution without it, which exceeds the threshold, or else that of the common
  /// shift of all loops nearby that agree with it; kTooFew: how many distinct
  /// places its kind ties, which falls short of it.
  double value = 0.0;
  double threshold = 0.0;
  std::vector<std::size_t> against{};  ///< loops that are in and contradict it; the nearest, few
};

struct GateOptions {
  /// Frames (robots, odometry epochs) that only loops tie together are tied by so many that agree
  /// and start and end at distinct poses; fewer are left out.
  std::size_t loops_that_join = 3;
  /// By variable (Graph::variables()), any numbers; empty: robots, the top bytes of ids.
  std::vector<std::uint32_t> frames{};
  /// Asked now and then; false ends the work with StopReason::kInterrupted. Where
  /// SolveOptions::work is spent, it ends with kWorkLimit.
  std::function<bool()> keep_going{};
};

struct GatedSolution {
  std::vector<LeftOutLoop> left_out;  ///< ascending by factor
  std::size_t loops = 0;              ///< there were
  /// Of the chi2 of short cycles to what their stated information says: 1 where it is honest. All
  /// thresholds are times this.
  double noise_scale = 1.0;
  double threshold = 0.0;  ///< of chi2, for loops that are in
  SolveSummary summary;    ///< of the last solve; not usable: there is no verdict
};

/// As optimize(), with the loop closures that fit together; those that contradict the rest are
/// found and left out. Odometry and everything absolute is trusted.
///
/// Loops support each other where they tie nearby keyframes and agree (pairwise consistency:
/// Mangelson et al., "Pairwise consistent measurement set maximization", ICRA 2018, eq. 5, over
/// short stretches of odometry); of groups of such loops that contradict each other over longer
/// stretches the weaker go first. What is left is solved; where it does not fit, only the better
/// supported half is, and those loops, and clusters of loops that agree, go out of it that do not
/// fit where the map would be without them: both tests are exact up to linearization, by its
/// marginal covariance. What agrees with the solution comes back: supported loops first, lonely
/// ones last.
///
/// A function of the graph. The values of `graph` move to the solution; all its factors stay.
GatedSolution solve_gated(Graph& graph, const SolveOptions& options = {},
                          const GateOptions& gate = {});

}  // namespace cairn
