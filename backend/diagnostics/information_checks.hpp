// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "cairn/diagnostics/raw_graph.hpp"

namespace cairn {

/// Omega of an edge as its format defines it (for kG2oSe3 in the file's chart, not in radians).
Eigen::MatrixXd information_matrix(const RawGraph& graph, const RawLine& line);

/// Reports information that is not positive semidefinite, singular or zero, edge by edge. Edges the
/// readers refuse become `broken`.
void check_information(RawGraph& graph, Findings& findings, Repairs& repairs);

}  // namespace cairn
