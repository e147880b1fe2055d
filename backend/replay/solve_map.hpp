// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "cairn/graph/pose_graph.hpp"
#include "cairn/replay/settle.hpp"
#include "cairn/solver/solve_summary.hpp"

namespace cairn {

/// Nodes that factors tie together and that could not be solved.
struct UnsolvedPart {
  std::vector<NodeIndex> nodes;
  StopReason reason = StopReason::kNotFinite;
  std::uint32_t worst_factor = 0;  ///< place in PoseGraph::factors: the largest error at the start
};

/// A node that the measurements leave free in some directions; it stays where it was sent.
struct FreeNode {
  NodeIndex node = 0;
  Eigen::MatrixXd directions;  ///< as UnderConstrainedVariable
};

/// What a solve of a map found. Gate::kOpen and kWhole: a function of the set of its nodes and
/// enabled factors.
struct MapSolution {
  std::vector<std::pair<NodeIndex, Estimate>> estimates;  ///< but of what could not be solved
  double chi2 = 0.0;                                      ///< of what could be
  std::vector<UnsolvedPart> unsolved{};
  std::vector<FreeNode> free{};
  std::vector<LoopVerdict> verdicts{};  ///< that are new: another state, or the first look
  SolveSummary whole;                   ///< of the first try, with everything in it
  bool solved = false;                  ///< some part was, though a frozen map leaves no estimates

  /// Something was solved.
  [[nodiscard]] bool usable() const { return solved; }
};

/// settle(), and where that fails each connected component for itself: what is wrong with one robot
/// does not hold up the others. A solution that was interrupted, or reached the limit of its work,
/// has no estimates.
///
/// Gate::kQuick solves with the committed factors and the loop closures that have come since the
/// last solve, and is done where these fit (solver/loop_trial.hpp) and where none that is
/// quarantined would fit now. Else all verdicts are found anew.
MapSolution solve_map(const PoseGraph& map, const SettleOptions& options = {});

}  // namespace cairn
