// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cairn/graph/graph.hpp"
#include "cairn/solver/loop_gate.hpp"
#include "cairn/solver/solve_summary.hpp"

namespace cairn::cli {

/// What --gate found.
struct GateReport {
  struct LeftOut {
    VariableId from, to;
    LeftOutLoop verdict;
  };
  std::size_t loops = 0;
  double noise_scale = 1.0;
  std::vector<LeftOut> left_out{};
};

/// One run of `cairn optimize`, as its reports tell it.
struct OptimizeReport {
  std::vector<std::string> inputs;
  std::size_t vertices = 0, edges = 0;
  ErrorChart chart = ErrorChart::kG2o;
  std::optional<double> input_chi2{};  ///< as read; nothing where the file has no vertices
  std::optional<GateReport> gate{};
  SolveSummary summary{};
  double read_s = 0.0;
  std::optional<double> write_s{};  ///< nothing where no graph was written
};

/// The report of --json. Numbers that are not finite, and what a back-end cannot tell, are null.
std::string json_text(const OptimizeReport& report);

/// Largest resident memory of this process so far.
std::int64_t peak_rss_bytes();

}  // namespace cairn::cli
