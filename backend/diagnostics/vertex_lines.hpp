// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "cairn/diagnostics/components.hpp"
#include "cairn/diagnostics/structure_checks.hpp"
#include "cairn/graph/graph.hpp"

namespace cairn {

/// Writes the starts that edges give: into vertex lines with broken numbers, and as new lines for
/// vertices that several edges name and no line defines.
void repair_missing_vertices(const RawGraph& raw, const RawStructure& structure, const Graph& read,
                             Repairs& repairs);

/// Adds FIX for the pose the solver would hold anyway, in each part of a g2o file that nothing
/// holds.
void repair_gauge(const RawGraph& raw, const std::vector<Component>& components, Repairs& repairs);

}  // namespace cairn
