// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cairn/core/result.hpp"
#include "cairn/graph/pose_graph.hpp"

namespace cairn {

/// The estimates of a map, without the map: what a start need not take from the solves before.
struct EstimateSnapshot {
  Revision solved;  ///< as PoseGraph::solved_revision
  double chi2 = 0.0;
  std::vector<Estimate> estimates;  ///< by node
};

/// Version 1: u16 version, solved revision (u64, u32, u64), f64 chi2, u32 count, 7 f64 each;
/// little-endian.
std::string encode_snapshot(const PoseGraph& map, double chi2);
/// The inverse. Refuses other versions, and whatever encode_snapshot() cannot have made.
Result<EstimateSnapshot> decode_snapshot(std::string_view bytes);

}  // namespace cairn
