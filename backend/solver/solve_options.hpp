// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "cairn/core/work_budget.hpp"
#include "cairn/graph/factor_batch.hpp"
#include "cairn/graph/robust_loss.hpp"
#include "cairn/linear/elimination_cache.hpp"
#include "cairn/linear/kernel.hpp"

namespace cairn {

enum class Method { kLevenbergMarquardt, kGaussNewton, kDogleg };
enum class LinearBackend { kMultifrontal, kCholmod, kCeres, kEigen, kPcg };
enum class InitMethod { kAuto, kFile, kOdometry, kTree, kChordal };

struct IterationReport {
  double chi2 = 0.0;    ///< at the best iterate after this iteration
  double lambda = 0.0;  ///< damping (dogleg: trust radius)
  bool accepted = false;
  double linearize_s = 0.0, factorize_s = 0.0, solve_s = 0.0, total_s = 0.0;
};

struct SolveOptions {
  Method method = Method::kLevenbergMarquardt;
  LinearBackend linear = LinearBackend::kMultifrontal;
  Kernel kernel = Kernel::kFastest;  ///< must be runnable; other kernels round differently
  InitMethod init = InitMethod::kFile;
  int max_iterations = 100;
  RobustLoss loss{};
  bool loss_on_loops_only = false;
  ErrorChart chart = ErrorChart::kG2o;
  int threads =
      1;  ///< at most, for linearization: small graphs use fewer. Results do not depend on it
  /// Called after each iteration from the solving thread (number from 1, report). Return false to
  /// stop early: the best iterate so far is kept and the stop reason is kInterrupted.
  std::function<bool(int, const IterationReport&)> on_iteration{};
  /// Ends the solve with StopReason::kWorkLimit, after an iteration, where it is spent. Not owned.
  WorkBudget* work = nullptr;
  /// Remembers orders of elimination from one solve to the next. Not owned.
  EliminationCache* eliminations = nullptr;
};

}  // namespace cairn
