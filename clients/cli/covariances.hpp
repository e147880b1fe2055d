// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cairn/core/result.hpp"
#include "cairn/graph/graph.hpp"
#include "cairn/solver/solve_options.hpp"

namespace cairn::cli {

/// Lines "id,dim,upper triangle row-major" of every variable's marginal covariance, in the order of
/// the file (m, rad; tangent space of the variable; nan where it is under-constrained). No heading
/// line.
Result<std::string> covariance_text(const Graph& graph, const SolveOptions& options);

}  // namespace cairn::cli
