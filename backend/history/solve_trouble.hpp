// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cairn/journal/journal.hpp"
#include "cairn/replay/map_head.hpp"
#include "cairn/replay/solve_map.hpp"

/// What a solve could not do, in words for an operator: which nodes, and which record is to blame.
namespace cairn {

/// "3 nodes cannot be solved (not_finite) and stay where they were: ..., the largest error is that
/// of factor 0 in record 12 (laser, sequence 5)".
std::string describe(const UnsolvedPart& part, const MapHead& head, const Journal& journal);
/// "robot/1/4 of record 5 (laser, sequence 5) is free in 1 direction, (0 0 1), and stays where it
/// was sent"; of many the first.
std::string describe(const std::vector<FreeNode>& free, const MapHead& head,
                     const Journal& journal);

/// "the loop closure robot/1/4 - robot/1/90 of record 12 (factor 0) is quarantined, does not fit
/// the map: 512 (limit 99.4); contradicted by record 9 (factor 0)".
std::string describe(const LoopVerdict& verdict, const MapHead& head);

}  // namespace cairn
