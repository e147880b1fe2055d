// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/ceres_backend.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "cairn/linear/single_thread_blas.hpp"

namespace cairn {
namespace {

constexpr int kMaxArity = 3;
constexpr int kMaxDimension = 6;

/// Numbers in Ceres' copy of a variable: (x, y, theta), (x, y, z, qx, qy, qz, qw), or the point.
constexpr int ambient_dimension(VariableType type) {
  constexpr int kDimensions[] = {3, 7, 2, 3};
  return kDimensions[static_cast<int>(type)];
}

void pack(const Se2& T, double* x) { Eigen::Map<Eigen::Vector3d>{x} = T.to_vector(); }
void pack(const Se3& T, double* x) {
  Eigen::Map<Eigen::Vector3d>{x} = T.translation();
  Eigen::Map<Eigen::Vector4d>{x + 3} = T.rotation().quaternion().coeffs();
}
void unpack(const double* x, Se2& T) { T = Se2(x[0], x[1], x[2]); }
void unpack(const double* x, Se3& T) {
  T = Se3(So3(Eigen::Quaterniond(x + 3)), Eigen::Vector3d(x));
}

/// T [+] d = T * Exp(d). Our factors give Jacobians in the tangent space already, so the derivative
/// of Plus is "lifted" to [I; 0] and factors pad their Jacobians with zero columns: the product
/// Ceres forms is ours.
template <class Pose, int kAmbient, int kTangent>
class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kAmbient; }
  int TangentSize() const override { return kTangent; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    Pose T;
    unpack(x, T);
    pack(T.retract(typename Pose::Tangent(delta)), x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, kAmbient, kTangent, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Pose T_y, T_x;
    unpack(y, T_y);
    unpack(x, T_x);
    Eigen::Map<typename Pose::Tangent>{y_minus_x} = (T_x.inverse() * T_y).log();
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, kTangent, kAmbient, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
};

/// Our loss on s = |r|^2. Ceres ignores second derivatives that are <= 0, as all of ours are.
class Loss final : public ceres::LossFunction {
 public:
  explicit Loss(RobustLoss loss) : loss_(loss) {}
  void Evaluate(double s, double rho[3]) const override {
    const RobustLoss::Value value = loss_.evaluate(s);
    rho[0] = value.rho;
    rho[1] = value.weight;
    rho[2] = 0.0;
  }

 private:
  RobustLoss loss_;
};

/// All variables as Ceres sees them, and their copy in `values`, where factors read poses.
class State final : public ceres::EvaluationCallback {
 public:
  Values values;

  explicit State(const Values& start) : values(start) {
    std::size_t next = 0;
    const auto place = [&](VariableType type, std::size_t count) {
      begin_[static_cast<std::size_t>(type)] = next;
      next += count * static_cast<std::size_t>(ambient_dimension(type));
    };
    place(VariableType::kPose2, values.pose2.size());
    place(VariableType::kPose3, values.pose3.size());
    place(VariableType::kPoint2, values.point2.size());
    place(VariableType::kPoint3, values.point3.size());
    numbers_.resize(next);
    for_each([](auto& value, double* x) {
      if constexpr (requires { value.data(); }) {
        std::copy_n(value.data(), value.size(), x);
      } else {
        pack(value, x);
      }
    });
  }

  double* block(VariableType type, std::uint32_t index) {
    return &numbers_[begin_[static_cast<std::size_t>(type)] +
                     static_cast<std::size_t>(ambient_dimension(type)) * index];
  }

  void PrepareForEvaluation(bool /*jacobians*/, bool /*new_point*/) override { update_values(); }

  void update_values() {
    for_each([](auto& value, const double* x) {
      if constexpr (requires { value.data(); }) {
        std::copy_n(x, value.size(), value.data());
      } else {
        unpack(x, value);
      }
    });
  }

 private:
  template <class Function>
  void for_each(const Function& function) {
    const auto over = [&](VariableType type, auto& array) {
      for (std::uint32_t i = 0; i < array.size(); ++i) function(array[i], block(type, i));
    };
    over(VariableType::kPose2, values.pose2);
    over(VariableType::kPose3, values.pose3);
    over(VariableType::kPoint2, values.point2);
    over(VariableType::kPoint3, values.point3);
  }

  std::vector<double> numbers_;
  std::array<std::size_t, 4> begin_;
};

/// One factor of a batch.
class FactorCost final : public ceres::CostFunction {
 public:
  FactorCost(const FactorBatch& batch, std::size_t factor, const EvaluationContext& context)
      : batch_(batch), factor_(factor), context_(context) {
    set_num_residuals(batch.residual_dimension());
    for (const VariableType type : batch.signature()) {
      mutable_parameter_block_sizes()->push_back(ambient_dimension(type));
    }
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    if (!jacobians) {
      batch_.evaluate_into(factor_, context_, residuals, nullptr);
      return true;
    }
    std::array<double, kMaxArity * kMaxDimension * kMaxDimension> tangent;
    std::array<double*, kMaxArity> tangents{};
    for (std::size_t k = 0; k < parameter_block_sizes().size(); ++k) {
      if (jacobians[k]) tangents[k] = &tangent[k * kMaxDimension * kMaxDimension];
    }
    batch_.evaluate_into(factor_, context_, residuals, tangents.data());
    for (std::size_t k = 0; k < parameter_block_sizes().size(); ++k) {
      if (jacobians[k]) lift(tangents[k], k, jacobians[k]);
    }
    return true;
  }

 private:
  // Column-major rows x tangent to row-major rows x ambient, zeros at the end of each row.
  void lift(const double* tangent, std::size_t k, double* ambient) const {
    const int rows = num_residuals();
    const int columns = parameter_block_sizes()[k];
    const int tangents = tangent_dimension(batch_.signature()[k]);
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < columns; ++j) *ambient++ = j < tangents ? tangent[j * rows + i] : 0.0;
    }
  }

  const FactorBatch& batch_;
  std::size_t factor_;
  const EvaluationContext& context_;
};

RangeCost total_cost(const Problem& problem, const EvaluationContext& context) {
  RangeCost sum;
  for (const FactorBatch* batch : problem.batches) {
    const RangeCost part = batch->evaluate_cost(0, batch->size(), context);
    sum.chi2 += part.chi2;
    sum.cost += part.cost;
  }
  return sum;
}

/// Turns Ceres' iterations into ours.
class Progress final : public ceres::IterationCallback {
 public:
  Progress(const Problem& problem, const SolveOptions& options, State& state, SolveSummary& summary)
      : problem_(problem), options_(options), state_(state), summary_(summary) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& iteration) override {
    if (iteration.iteration == 0) {
      chi2_ = summary_.initial_chi2;
      return ceres::SOLVER_CONTINUE;
    }
    if (iteration.step_is_successful) {
      chi2_ =
          options_.loss.kind() == RobustLoss::Kind::kNone ? 2.0 * iteration.cost : current_chi2();
      // Ceres keeps actual / predicted decrease; the prediction is what usability asks for.
      if (iteration.relative_decrease > 0.0) {
        predicted_decrease = 2.0 * iteration.cost_change / iteration.relative_decrease;
      }
    }
    summary_.iterations.push_back({.chi2 = chi2_,
                                   .lambda = 1.0 / iteration.trust_region_radius,
                                   .accepted = iteration.step_is_successful,
                                   .factorize_s = iteration.step_solver_time_in_seconds,
                                   .total_s = iteration.iteration_time_in_seconds});
    if (options_.on_iteration &&
        !options_.on_iteration(iteration.iteration, summary_.iterations.back())) {
      return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    }
    return ceres::SOLVER_CONTINUE;
  }

  double predicted_decrease = std::numeric_limits<double>::infinity();

 private:
  double current_chi2() {
    state_.update_values();
    return total_cost(problem_, {.values = state_.values, .chart = options_.chart}).chi2;
  }

  const Problem& problem_;
  const SolveOptions& options_;
  State& state_;
  SolveSummary& summary_;
  double chi2_ = 0.0;
};

EvaluationContext context_of(const Values& values, const SolveOptions& options) {
  return {.values = values,
          .chart = options.chart,
          .loss = options.loss,
          .loss_on_loops_only = options.loss_on_loops_only};
}

ceres::Problem::Options problem_options(ceres::EvaluationCallback* callback) {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  options.evaluation_callback = callback;
  return options;
}

/// The Ceres problem and everything it points to.
class CeresProblem {
 public:
  CeresProblem(const Problem& problem, const EvaluationContext& context, State& state)
      : context_(context), loss_(context.loss), problem_(problem_options(&state)) {
    for (std::size_t slot = 0; slot < problem.held.size(); ++slot) {
      const Variable& variable = problem.graph->variables()[slot];
      double* block = state.block(variable.type, variable.index);
      problem_.AddParameterBlock(block, ambient_dimension(variable.type), manifold(variable.type));
      if (problem.held[slot]) problem_.SetParameterBlockConstant(block);
    }
    for (const FactorBatch* batch : problem.batches) add(*batch, state);
  }

  void solve(const ceres::Solver::Options& options, ceres::Solver::Summary& summary) {
    ceres::Solve(options, &problem_, &summary);
  }

 private:
  ceres::Manifold* manifold(VariableType type) {
    if (type == VariableType::kPose2) return &pose2_;
    if (type == VariableType::kPose3) return &pose3_;
    return nullptr;
  }

  void add(const FactorBatch& batch, State& state) {
    const auto signature = batch.signature();
    std::array<double*, kMaxArity> blocks;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      for (std::size_t k = 0; k < signature.size(); ++k) {
        blocks[k] = state.block(signature[k], batch.variable_indices()[i * signature.size() + k]);
      }
      costs_.emplace_back(batch, i, context_);
      problem_.AddResidualBlock(&costs_.back(),
                                context_.robust(batch.kinds()[i]) ? &loss_ : nullptr, blocks.data(),
                                static_cast<int>(signature.size()));
    }
  }

  const EvaluationContext& context_;
  Loss loss_;
  PoseManifold<Se2, 3, 3> pose2_;
  PoseManifold<Se3, 7, 6> pose3_;
  std::deque<FactorCost> costs_;
  ceres::Problem problem_;
};

ceres::Solver::Options solver_options(const SolveOptions& options,
                                      ceres::IterationCallback* progress) {
  ceres::Solver::Options ceres;
  ceres.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  ceres.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  ceres.trust_region_strategy_type =
      options.method == Method::kDogleg ? ceres::DOGLEG : ceres::LEVENBERG_MARQUARDT;
  ceres.initial_trust_region_radius = options.method == Method::kLevenbergMarquardt ? 1e12 : 1e16;
  ceres.max_trust_region_radius = 1e32;
  ceres.max_num_iterations = options.max_iterations;
  // Far below the 1e-6 relative that results are held to.
  ceres.function_tolerance = 1e-10;
  ceres.parameter_tolerance = 1e-12;
  ceres.gradient_tolerance = 1e-10;
  ceres.num_threads = 1;
  ceres.logging_type = ceres::SILENT;
  ceres.callbacks.push_back(progress);
  ceres.update_state_every_iteration = options.loss.kind() != RobustLoss::Kind::kNone;
  return ceres;
}

// Ceres has no enumeration for this; its messages name the tolerance.
StopReason convergence_reason(const std::string& message) {
  const auto says = [&](const char* text) { return message.find(text) != std::string::npos; };
  if (says("Gradient tolerance")) return StopReason::kGradient;
  if (says("Parameter tolerance")) return StopReason::kSmallStep;
  if (says("Minimum trust region radius")) return StopReason::kLambdaExhausted;
  return StopReason::kSmallDecrease;
}

void fill_outcome(const ceres::Solver::Summary& ceres, double predicted_decrease,
                  SolveSummary& summary) {
  const bool near_optimum = predicted_decrease <= 1e-6 * std::max(summary.final_chi2, 1.0);
  summary.status = SolveStatus::kFailed;
  summary.usable_result = false;
  switch (ceres.termination_type) {
    case ceres::CONVERGENCE:
      summary.stop_reason = convergence_reason(ceres.message);
      summary.usable_result = summary.stop_reason != StopReason::kLambdaExhausted || near_optimum;
      if (summary.usable_result) summary.status = SolveStatus::kConverged;
      break;
    case ceres::NO_CONVERGENCE:
      summary.stop_reason = StopReason::kIterationLimit;
      summary.status = SolveStatus::kIterationLimit;
      summary.usable_result = near_optimum;
      break;
    case ceres::USER_SUCCESS:
      summary.stop_reason = StopReason::kInterrupted;
      summary.usable_result = near_optimum;
      break;
    case ceres::FAILURE:
    case ceres::USER_FAILURE:
      summary.stop_reason = std::isfinite(summary.initial_chi2) ? StopReason::kLambdaExhausted
                                                                : StopReason::kNotFinite;
      break;
  }
}

}  // namespace

void solve_with_ceres(const Problem& problem, const SolveOptions& options, Values& values,
                      SolveSummary& summary) {
  const SingleThreadBlas single_thread;
  summary.linear = LinearBackend::kCeres;
  summary.threads = 1;
  summary.iterations.clear();
  const RangeCost start = total_cost(problem, context_of(values, options));
  summary.initial_chi2 = summary.final_chi2 = start.chi2;
  summary.final_cost = start.cost;
  if (!std::isfinite(start.cost)) {
    summary.status = SolveStatus::kFailed;
    summary.stop_reason = StopReason::kNotFinite;
    summary.usable_result = false;
    return;
  }

  State state(values);
  const EvaluationContext context = context_of(state.values, options);
  CeresProblem ceres_problem(problem, context, state);
  Progress progress(problem, options, state, summary);
  ceres::Solver::Summary ceres_summary;
  ceres_problem.solve(solver_options(options, &progress), ceres_summary);

  state.update_values();
  const RangeCost end = total_cost(problem, context);
  if (end.cost <= start.cost) {  // otherwise the start stays: it is the best iterate
    values = state.values;
    summary.final_chi2 = end.chi2;
    summary.final_cost = end.cost;
  }
  fill_outcome(ceres_summary, progress.predicted_decrease, summary);
}

}  // namespace cairn
