// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cairn/diagnostics/raw_graph.hpp"

namespace cairn {

/// Looks at the numbers of each line (quaternions, information) and at the conventions the lines
/// share (degrees, order of the information, order of the quaternion). Lines whose information the
/// readers refuse become `broken`.
void check_values(RawGraph& graph, Findings& findings, Repairs& repairs);

}  // namespace cairn
