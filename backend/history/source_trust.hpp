// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cairn/graph/pose_graph.hpp"

namespace cairn {

/// How honest a source is about the covariances of what it sends of one robot.
struct SourceTrust {
  std::string source{}, robot{};
  FactorKind kind = FactorKind::kOther;
  std::size_t factors = 0;    ///< that others say anything about
  double redundancy = 0.0;    ///< how many numbers these were checked against
  double sigma_factor = 1.0;  ///< its errors are so many times as large as it states
};

/// Of each source, robot and kind, from the factors that take part and that a solve has seen: the
/// normalized innovation of each (innovation_inside(), at the map's estimates), over the median of
/// chi-square with as many degrees of freedom; of that the median, so that a few false ones do not
/// count; its square root. A factor between two robots counts for both. Where fewer than 10 numbers
/// check it, nothing is said. At most 256 rows, those checked most; by source, robot and kind.
///
/// Costs about what a solve does: a linearization, a factorization, a selected inverse.
std::vector<SourceTrust> measure_trust(const PoseGraph& map);

/// "3.1x over-confident", "honest", "2x under-confident".
std::string describe(const SourceTrust& trust);

}  // namespace cairn
