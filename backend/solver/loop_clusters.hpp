// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "cairn/solver/loop_fit.hpp"

namespace cairn {

/// Loops between two chains of odometry hold each other: a few that agree, and that the map gives
/// way to, fit it whatever they say. Finds those that take part (`in`, by place in
/// LoopCycles::loops()) and are not where `solved` would have them without them.
///
/// What nearby loops agree on, at `noise_scale`, is a cluster. It is judged by the common shift
/// that fits its loops best: with their whitened errors r, the joint covariance S of these in the
/// solution, and the Jacobian A of the shift, r^T A (A^T (I - S) A)^-1 A^T r is its squared
/// Mahalanobis distance from none. The limit, times `scale`, is largest_chi2() where the rest of
/// the map holds the cluster's place, and a quarter of that where nothing does.
///
/// The worst first, then what is as bad without it as far as linearization tells: solve and ask
/// again. Of very many loops the larger clusters are left in unseen.
template <class Pose>
std::vector<std::size_t> find_shifted_clusters(const LoopCycles<Pose>& cycles, const Graph& solved,
                                               const LoopFit<Pose>& fit,
                                               const std::vector<bool>& in,
                                               const Marginals& marginals, double noise_scale,
                                               double scale);

}  // namespace cairn
