// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cairn/core/result.hpp"
#include "clients/cli/report.hpp"

namespace cairn::cli {

/// What the picture of an optimization shows.
struct BeforeAndAfter {
  const Graph& graph;  ///< optimized
  const Values& input_values;
  const OptimizeReport& report;
  const Graph* truth = nullptr;
};

/// Draws the graph as read beside the optimized one, with chi2 and (where the truth is known)
/// trajectory error.
Result<void> draw_before_and_after(const BeforeAndAfter& picture, const std::string& path);

}  // namespace cairn::cli
