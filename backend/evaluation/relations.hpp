// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "cairn/evaluation/trajectory_error.hpp"
#include "cairn/io/relations.hpp"
#include "cairn/io/trajectory.hpp"

namespace cairn {

/// How an estimate moved where the truth is known.
struct RelationErrors {
  PoseErrors errors;                   ///< `at`: the relation
  std::vector<std::size_t> unmatched;  ///< relations that lack a pose at one end
};

inline constexpr std::uint64_t kDefaultRelationDifferenceNs = 1'000;

/// Kuemmerle et al., "On measuring the accuracy of SLAM algorithms" (Autonomous Robots 2009): of
/// each relation T_true^-1 * T_estimated. The poses are those nearest in time to a relation's ends
/// and at most `max_difference_ns` away; of repeated stamps the first. One pose may serve many
/// relations. The estimate must have time stamps; matching none is no error.
Result<RelationErrors> relation_errors(
    const Relations& reference, const Trajectory& estimate,
    std::uint64_t max_difference_ns = kDefaultRelationDifferenceNs);

}  // namespace cairn
