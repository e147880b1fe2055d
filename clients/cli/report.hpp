// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cairn/graph/graph.hpp"
#include "cairn/solver/solve_summary.hpp"

namespace cairn::cli {

/// One run of `cairn optimize`, as its reports tell it.
struct OptimizeReport {
  std::vector<std::string> inputs;
  std::size_t vertices = 0, edges = 0;
  ErrorChart chart = ErrorChart::kG2o;
  std::optional<double> input_chi2{};  ///< as read; nothing where the file has no vertices
  SolveSummary summary{};
  double read_s = 0.0;
  std::optional<double> write_s{};  ///< nothing where no graph was written
};

/// The report of --json. Numbers that are not finite, and what a back-end cannot tell, are null.
std::string json_text(const OptimizeReport& report);

/// Largest resident memory of this process so far.
std::int64_t peak_rss_bytes();

}  // namespace cairn::cli
