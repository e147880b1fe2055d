// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cairn/diagnostics/structure_checks.hpp"

namespace cairn {

/// Reads the sound lines as a graph (broken edges count as connections only) and looks at the
/// whole: parts, gauge, variables no measurement determines, and whether the information fits the
/// residuals. The last needs a solve; it is left out, and said so, where `solve` is false, lines
/// are broken, or the graph is very large.
void check_graph(RawGraph& raw, const RawStructure& structure, const std::string& name, bool solve,
                 Findings& findings, Repairs& repairs);

}  // namespace cairn
