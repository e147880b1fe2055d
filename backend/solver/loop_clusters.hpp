// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "cairn/solver/loop_fit.hpp"

namespace cairn {

/// A loop of a cluster that is out of place: the cluster's chi2 exceeds its limit, `excess` times.
struct ShiftedLoop {
  std::size_t loop;  ///< by place in LoopCycles::loops()
  double chi2;
  double excess;
};

/// Loops that say the same hold each other: alone each fits a map that gave way to all of them.
/// Finds those that take part (`in`, by place in LoopCycles::loops()) and are not where `solved`
/// would have them without their whole cluster: loops of which `agreeing` are pairs, and single
/// ones between two chains of odometry.
///
/// A cluster is judged by the common shift that fits its loops best: with their whitened errors r,
/// the joint covariance S of these in the solution, and the Jacobian A of the shift,
/// r^T A (A^T (I - S) A)^-1 A^T r is its squared Mahalanobis distance from none. The limit, times
/// `scale`, is largest_chi2(); between chains that is so only where the rest of the map holds the
/// cluster's place as well as the cluster itself does, and half of it (in space 0.15) where nothing
/// does.
///
/// The worst first, then what is as bad without it as far as linearization tells: solve and ask
/// again. S_ij is bounded by S_ii and S_jj first, and computed where this does not acquit a
/// cluster; of very many the least suspicious are let go.
template <class Pose>
std::vector<ShiftedLoop> find_shifted_clusters(
    const LoopCycles<Pose>& cycles,
    const std::vector<std::pair<std::size_t, std::size_t>>& agreeing, const Graph& solved,
    const LoopFit<Pose>& fit, const std::vector<bool>& in, const Marginals& marginals,
    double scale);

}  // namespace cairn
