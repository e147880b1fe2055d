// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/summary.hpp"

#include <algorithm>
#include <cstdio>

namespace cairn::cli {
namespace {

constexpr std::size_t kShown = 10;

template <class... Arguments>
std::string format(const char* pattern, Arguments... arguments) {
  char text[512];
  std::snprintf(text, sizeof text, pattern, arguments...);
  return text;
}

std::string name_inputs(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words)
    text += (text.empty() ? "" : " + ") + (word == "-" ? "standard input" : word);
  return text;
}

std::string initialization_line(const SolveSummary& summary) {
  std::string line = "start:         " + std::string(to_string(summary.init_chosen));
  line += format(", chi2 %.10g", summary.initial_chi2);
  if (summary.init_candidates.size() < 2) return line;
  std::string others;
  for (const InitCandidate& candidate : summary.init_candidates) {
    others += (others.empty() ? "" : ", ") + std::string(to_string(candidate.method)) +
              format(" %.6g", candidate.chi2);
  }
  return line + " (tried: " + others + ")";
}

const char* advice(StopReason reason) {
  switch (reason) {
    case StopReason::kIterationLimit:
      return "raise --max-iterations, or try --init chordal";
    case StopReason::kLambdaExhausted:
      return "no step lowers the cost any more: try --init chordal or --method dogleg";
    case StopReason::kNotFinite:
      return "the cost is not a finite number: run `cairn check` on the input";
    case StopReason::kInterrupted:
    case StopReason::kWorkLimit:
      return "it was interrupted: let it run, or limit it with --max-iterations";
    default:
      return "run `cairn check` on the input";
  }
}

}  // namespace

std::string input_line(const OptimizeReport& report) {
  std::string line = "input:         " + name_inputs(report.inputs);
  line += format(": %zu vertices, %zu edges, read in %.3f s", report.vertices, report.edges,
                 report.read_s);
  return report.input_chi2 ? line + format(", chi2 %.10g", *report.input_chi2)
                           : line + ", no start values";
}

std::string progress_line(int iteration, const IterationReport& report, double seconds) {
  return format("iteration %d  chi2 %.10g  damping %.1e  %s  %.1f s", iteration, report.chi2,
                report.lambda, report.accepted ? "accepted" : "rejected", seconds);
}

std::vector<std::string> solve_lines(const OptimizeReport& report) {
  const SolveSummary& summary = report.summary;
  const std::string status(to_string(summary.status)), reason(to_string(summary.stop_reason));
  return {initialization_line(summary),
          format("result:        %s (%s) after %zu iterations in %.3f s", status.c_str(),
                 reason.c_str(), summary.iterations.size(), summary.optimize_s),
          format("chi2:          %.10g -> %.10g, %lld degrees of freedom, %d component%s",
                 summary.initial_chi2, summary.final_chi2,
                 static_cast<long long>(summary.degrees_of_freedom), summary.components,
                 summary.components == 1 ? "" : "s")};
}

std::string gate_line(const GateReport& gate) {
  std::string line = format("gate:          %zu of %zu loop closures left out%s",
                            gate.left_out.size(), gate.loops, gate.left_out.empty() ? "" : ": ");
  for (std::size_t i = 0; i < std::min(gate.left_out.size(), kShown); ++i) {
    const auto& [from, to, verdict] = gate.left_out[i];
    line += format("%s%llu - %llu (%s: %.3g, limit %.3g)", i == 0 ? "" : ", ",
                   static_cast<unsigned long long>(from.value),
                   static_cast<unsigned long long>(to.value),
                   std::string(to_string(verdict.test)).c_str(), verdict.value, verdict.threshold);
  }
  if (gate.left_out.size() > kShown)
    line += format(", and %zu more (--json lists them)", gate.left_out.size() - kShown);
  return line;
}

std::string truth_line(const TruthComparison& before, const TruthComparison& after) {
  return format("error:         ATE %.6g m -> %.6g m (rmse of %zu poses, aligned to the truth)",
                before.ate_rmse_m, after.ate_rmse_m, after.poses);
}

std::vector<std::string> warning_lines(const std::vector<std::string>& warnings) {
  std::vector<std::string> lines(
      warnings.begin(),
      warnings.begin() + static_cast<std::ptrdiff_t>(std::min(warnings.size(), kShown)));
  if (warnings.size() > kShown) {
    lines.push_back(
        format("%zu more warnings; `cairn check` lists them", warnings.size() - kShown));
  }
  return lines;
}

std::string under_constrained_line(const SolveSummary& summary) {
  const auto& free = summary.under_constrained;
  std::string line =
      format("warning: %zu variables are not determined by the measurements and keep their value:",
             free.size());
  for (std::size_t i = 0; i < std::min(free.size(), kShown); ++i) {
    line += format("%s %llu (%d free)", i == 0 ? "" : ",",
                   static_cast<unsigned long long>(free[i].id.value),
                   static_cast<int>(free[i].free_directions.cols()));
  }
  return free.size() > kShown ? line + ", ..." : line;
}

std::string why_not_usable(const SolveSummary& summary, bool refused_by_strict) {
  if (refused_by_strict)
    return "not usable: --strict refuses variables that are not determined; no graph was written";
  return "not usable: stopped with " + std::string(to_string(summary.stop_reason)) +
         "; no graph was written; " + advice(summary.stop_reason);
}

}  // namespace cairn::cli
