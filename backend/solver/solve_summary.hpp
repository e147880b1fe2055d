// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cairn/core/ids.hpp"
#include "cairn/solver/solve_options.hpp"

namespace cairn {

enum class SolveStatus { kConverged, kPartiallyConstrained, kIterationLimit, kFailed };
enum class StopReason {
  kSmallStep,
  kSmallDecrease,
  kGradient,
  kIterationLimit,
  kLambdaExhausted,
  kNotFinite,
  kInterrupted,
  kWorkLimit,
};
std::string_view to_string(SolveStatus status);     ///< as in the JSON report: "converged", ...
std::string_view to_string(StopReason reason);      ///< "small_step", ...
std::string_view to_string(InitMethod method);      ///< "file", ...
std::string_view to_string(LinearBackend backend);  ///< "multifrontal", ...
std::string_view to_string(ErrorChart chart);       ///< "g2o", ...

/// A variable that the measurements leave free in some directions.
struct UnderConstrainedVariable {
  VariableId id;
  /// Orthonormal columns in the tangent space of the variable (translation m, rotation rad).
  Eigen::MatrixXd free_directions;
};

struct InitCandidate {
  InitMethod method;
  double chi2;
  double seconds;
};

struct SolveSummary {
  SolveStatus status = SolveStatus::kFailed;
  StopReason stop_reason = StopReason::kNotFinite;
  bool usable_result = false;

  double initial_chi2 = 0.0;  ///< after initialization
  double final_chi2 = 0.0;    ///< never robustified, never halved
  double final_cost = 0.0;    ///< half the sum of rho
  std::vector<IterationReport> iterations;

  InitMethod init_chosen = InitMethod::kFile;
  std::vector<InitCandidate> init_candidates;

  int components = 0;  ///< connected components of the graph
  std::vector<VariableId>
      gauge;  ///< poses held at their start value, one per component that needed it
  std::int64_t degrees_of_freedom =
      0;  ///< measurement rows - variable dimensions + gauge dimensions
  std::vector<UnderConstrainedVariable> under_constrained;

  double setup_s = 0.0;     ///< initialization, structure and analysis
  double optimize_s = 0.0;  ///< everything, setup included
  int threads = 1;          ///< used
  LinearBackend linear = LinearBackend::kMultifrontal;
  std::string ordering;  ///< "amd", "metis"; empty where the back-end has none
  std::optional<std::int64_t> factor_nonzeros;  ///< null where the back-end does not tell

  /// True when the estimates may be used: converged, partially constrained, or stopped where a
  /// Gauss-Newton step would gain at most 1e-6 of max(chi2, 1).
  [[nodiscard]] bool usable() const { return usable_result; }
};

/// One line: why it stopped, iterations, chi2 before -> after, seconds.
std::ostream& operator<<(std::ostream& out, const SolveSummary& summary);

}  // namespace cairn
