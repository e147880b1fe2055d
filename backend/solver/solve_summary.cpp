// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/solve_summary.hpp"

#include <ostream>

namespace cairn {
namespace {

template <class Enum, std::size_t N>
std::string_view name_of(const std::string_view (&names)[N], Enum value) {
  return names[static_cast<std::size_t>(value)];
}

}  // namespace

std::string_view to_string(SolveStatus status) {
  constexpr std::string_view kNames[] = {"converged", "partially_constrained", "iteration_limit",
                                         "failed"};
  return name_of(kNames, status);
}

std::string_view to_string(StopReason reason) {
  constexpr std::string_view kNames[] = {"small_step",      "small_decrease",   "gradient",
                                         "iteration_limit", "lambda_exhausted", "not_finite",
                                         "interrupted",     "work_limit"};
  return name_of(kNames, reason);
}

std::string_view to_string(InitMethod method) {
  constexpr std::string_view kNames[] = {"auto", "file", "odometry", "tree", "chordal"};
  return name_of(kNames, method);
}

std::string_view to_string(LinearBackend backend) {
  constexpr std::string_view kNames[] = {"multifrontal", "cholmod", "ceres", "eigen", "pcg"};
  return name_of(kNames, backend);
}

std::string_view to_string(ErrorChart chart) {
  constexpr std::string_view kNames[] = {"g2o", "log", "gtsam"};
  return name_of(kNames, chart);
}

std::ostream& operator<<(std::ostream& out, const SolveSummary& summary) {
  return out << to_string(summary.status) << " (" << to_string(summary.stop_reason) << ") after "
             << summary.iterations.size() << " iterations: chi2 " << summary.initial_chi2 << " -> "
             << summary.final_chi2 << " in " << summary.optimize_s << " s";
}

}  // namespace cairn
