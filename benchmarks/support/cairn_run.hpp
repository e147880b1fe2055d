// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "cairn/graph/graph.hpp"
#include "cairn/solver/optimize.hpp"

namespace cairn::bench {

/// A run of Cairn to a target.
struct CairnRun {
  std::optional<double>
      to_optimum_s;  ///< wall time to the first iterate within the target, set-up included
  int iterations = 0;
  double final_chi2 = 0.0;
  InitMethod init = InitMethod::kFile;  ///< the start that was chosen
  // Of to_optimum_s, s:
  double setup_s = 0.0, linearize_s = 0.0, factorize_s = 0.0, solve_s = 0.0;

  [[nodiscard]] double rest_s() const {
    return to_optimum_s.value_or(0.0) - setup_s - linearize_s - factorize_s - solve_s;
  }
};

/// Optimizes a copy of `graph` until chi2 <= target.
CairnRun run_cairn(const Graph& graph, double target_chi2, SolveOptions options = {});

/// The lower of the minima that Cairn and Ceres (tuned) find from this start.
double find_optimum(const Graph& start);

/// What a run to this optimum must reach: 1e-6 relative.
inline double target_of(double optimum) { return optimum * (1.0 + 1e-6); }

}  // namespace cairn::bench
