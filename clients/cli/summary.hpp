// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "clients/cli/report.hpp"
#include "clients/cli/truth.hpp"

namespace cairn::cli {

// The lines `cairn optimize` prints for people.

std::string input_line(const OptimizeReport& report);
std::string progress_line(int iteration, const IterationReport& report, double seconds);
std::vector<std::string> solve_lines(const OptimizeReport& report);
/// What --gate has left out.
std::string gate_line(const GateReport& gate);
std::string truth_line(const TruthComparison& before, const TruthComparison& after);
/// The first warnings, and how many more there are.
std::vector<std::string> warning_lines(const std::vector<std::string>& warnings);
std::string under_constrained_line(const SolveSummary& summary);
/// Why exit code 4, and what to try.
std::string why_not_usable(const SolveSummary& summary, bool refused_by_strict);

}  // namespace cairn::cli
