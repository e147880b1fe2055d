// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <set>

#include "cairn/graph/graph.hpp"
#include "cairn/solver/loop_gate.hpp"

namespace cairn::bench {

/// Root mean square distance of the poses from where `reference` has them, after a rigid
/// alignment, m. Both have the same poses.
double trajectory_error_m(const Graph& reference, const Graph& estimate);
/// Root mean square distance of the poses from their middle, m.
double extent_m(const Graph& graph);
/// Mean distance of the poses from the nearest pose of `truth`, after the rigid alignment in the
/// plane that brings them nearest, m. For a truth that says where the path was and not when.
double distance_to_path_m(const Graph& estimate, const Graph& truth);

/// Which of `loops` the graph without them, solved, cannot tell from true ones: the squared
/// Mahalanobis distance of their measurement from the solution, under both covariances and the
/// noise scale, is below the 99 % quantile of chi-square. In space.
std::set<std::size_t> indistinguishable(const Graph& graph, const Graph& solved_without,
                                        const std::set<std::size_t>& loops, double noise_scale);

/// Loops between two robots, two at a time: the cycle that they make with all odometry between
/// their ends, its covariance summed edge by edge (Mangelson et al. 2018, eq. 5).
struct PairScore {
  std::size_t pairs = 0;
  std::size_t consistent_as_stated = 0;  ///< at the 99 % quantile of chi-square
  std::size_t consistent = 0;            ///< the same times the noise scale
};
/// A slow referee that shares nothing with the gate, in space. `left_out`: places of factors that
/// do not count.
PairScore score_pairs(const Graph& graph, const std::set<std::size_t>& left_out,
                      double noise_scale);

}  // namespace cairn::bench
