// SPDX-License-Identifier: BSD-3-Clause
#include "benchmarks/support/ceres_rival.hpp"

#include <algorithm>

#include "benchmarks/support/measure.hpp"
#include "cairn/core/check.hpp"
#include "cairn/factors/between.hpp"

namespace cairn::bench {
namespace {

// e = (R(theta_a + theta_z)^T (t_b - t_a) - R_z^T t_z, theta_b - theta_a - theta_z), whitened.
class Between2Cost final : public ceres::SizedCostFunction<3, 3, 3> {
 public:
  explicit Between2Cost(const BetweenSe2& factor)
      : U_(sqrt_information<3>(factor.information)),
        theta_z_(factor.T_a_b_measured.theta()),
        offset_(factor.T_a_b_measured.inverse().translation()) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const double* a = parameters[0];
    const double* b = parameters[1];
    const double c = std::cos(a[2] + theta_z_), s = std::sin(a[2] + theta_z_);
    const double dx = b[0] - a[0], dy = b[1] - a[1];
    const double x = c * dx + s * dy, y = c * dy - s * dx;
    const Eigen::Vector3d e(x + offset_.x(), y + offset_.y(), wrap_angle(b[2] - a[2] - theta_z_));
    Eigen::Map<Eigen::Vector3d>{residuals}.noalias() = U_.lazyProduct(e);
    if (!jacobians) return true;
    using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    if (jacobians[0]) {
      Eigen::Matrix3d J;
      J << -c, -s, y, s, -c, -x, 0.0, 0.0, -1.0;
      Eigen::Map<RowMajor>{jacobians[0]}.noalias() = U_.lazyProduct(J);
    }
    if (jacobians[1]) {
      Eigen::Matrix3d J;
      J << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;
      Eigen::Map<RowMajor>{jacobians[1]}.noalias() = U_.lazyProduct(J);
    }
    return true;
  }

 private:
  Eigen::Matrix3d U_;
  double theta_z_;
  Eigen::Vector2d offset_;
};

Se3 pose3(const double* x) { return {So3(Eigen::Quaterniond(x + 3)), Eigen::Vector3d(x)}; }

// The same function of the same poses as ours; columns of the tangent space first, then a zero
// column.
class Between3Cost final : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  explicit Between3Cost(const BetweenSe3& factor)
      : factor_(factor), U_(sqrt_information<6>(factor.information)) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Se3 T_map_a = pose3(parameters[0]), T_map_b = pose3(parameters[1]);
    Eigen::Map<Vector6d> r(residuals);
    if (!jacobians) {
      r.noalias() =
          U_.lazyProduct(factor_.error(T_map_a, T_map_b, ErrorChart::kG2o, nullptr, nullptr));
      return true;
    }
    std::array<Matrix6d, 2> J;
    r.noalias() = U_.lazyProduct(factor_.error(T_map_a, T_map_b, ErrorChart::kG2o, &J[0], &J[1]));
    for (std::size_t k = 0; k < 2; ++k) {
      if (!jacobians[k]) continue;
      Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> out(jacobians[k]);
      out.leftCols<6>().noalias() = U_.lazyProduct(J[k]);
      out.rightCols<1>().setZero();
    }
    return true;
  }

 private:
  BetweenSe3 factor_;
  Matrix6d U_;
};

class Pose3Manifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const Se3 T = pose3(x).retract(Vector6d(delta));
    Eigen::Map<Eigen::Vector3d>{x_plus_delta} = T.translation();
    Eigen::Map<Eigen::Vector4d>{x_plus_delta + 3} = T.rotation().quaternion().coeffs();
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Map<Vector6d>{y_minus_x} = (pose3(x).inverse() * pose3(y)).log();
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
};

/// Notes when the target is reached, and stops there.
class Watch final : public ceres::IterationCallback {
 public:
  Watch(double target_chi2, const Stopwatch& start, CeresRun& run)
      : target_(target_chi2), start_(start), run_(run) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& iteration) override {
    if (2.0 * iteration.cost > target_) return ceres::SOLVER_CONTINUE;
    run_.to_optimum_s = start_.seconds();
    run_.iterations = iteration.iteration;
    return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

 private:
  double target_;
  const Stopwatch& start_;
  CeresRun& run_;
};

ceres::Solver::Options solver_options(CeresSettings settings) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  if (settings == CeresSettings::kTuned) {
    options.initial_trust_region_radius = 1e12;
    options.max_trust_region_radius = 1e32;
    options.jacobi_scaling = false;
    options.function_tolerance = 1e-12;
    options.gradient_tolerance = 1e-14;
    options.parameter_tolerance = 1e-14;
  }
  return options;
}

}  // namespace

VariableSlot gauge_slot(const Graph& graph) {
  const auto variables = graph.variables();
  VariableSlot smallest = 0;
  for (VariableSlot slot = 0; slot < variables.size(); ++slot) {
    if (variables[slot].fixed) return slot;
    if (variables[slot].id < variables[smallest].id) smallest = slot;
  }
  return smallest;
}

CeresPoseGraph::CeresPoseGraph(const Graph& graph)
    : graph_(graph), stride_(graph.values().pose3.empty() ? 3 : 7) {
  const std::size_t poses = graph.values().pose2.size() + graph.values().pose3.size();
  CAIRN_CHECK(poses == graph.variables().size() && graph.batches().size() == 1,
              "the rival takes pose graphs of one kind of pose");
  numbers_.resize(poses * stride_);
  reset();
}

CeresPoseGraph::~CeresPoseGraph() = default;

void CeresPoseGraph::reset() {
  double* x = numbers_.data();
  for (const Se2& T : graph_.values().pose2) {
    Eigen::Map<Eigen::Vector3d>{x} = T.to_vector();
    x += stride_;
  }
  for (const Se3& T : graph_.values().pose3) {
    Eigen::Map<Eigen::Vector3d>{x} = T.translation();
    Eigen::Map<Eigen::Vector4d>{x + 3} = T.rotation().quaternion().coeffs();
    x += stride_;
  }
}

void CeresPoseGraph::build() {
  reset();
  problem_.reset();
  costs_.clear();
  costs_.reserve(graph_.factor_count());
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  problem_ = std::make_unique<ceres::Problem>(options);
  if (stride_ == 7) manifold_ = std::make_unique<Pose3Manifold>();
  for (std::size_t i = 0; i < poses(); ++i) {
    problem_->AddParameterBlock(&numbers_[i * stride_], static_cast<int>(stride_), manifold_.get());
  }
  const auto add = [&]<class Cost, class F>(const TypedBatch<F>& batch) {
    for (std::size_t i = 0; i < batch.size(); ++i) {
      costs_.push_back(std::make_unique<Cost>(batch.factor(i)));
      problem_->AddResidualBlock(costs_.back().get(), nullptr,
                                 &numbers_[batch.variable_indices()[2 * i] * stride_],
                                 &numbers_[batch.variable_indices()[2 * i + 1] * stride_]);
    }
  };
  if (stride_ == 3) {
    add.operator()<Between2Cost>(*graph_.find_batch<BetweenSe2>());
  } else {
    add.operator()<Between3Cost>(*graph_.find_batch<BetweenSe3>());
  }
  problem_->SetParameterBlockConstant(
      &numbers_[graph_.variables()[gauge_slot(graph_)].index * stride_]);
}

CeresRun CeresPoseGraph::run(CeresSettings settings, double target_chi2, int max_iterations) {
  CeresRun run;
  const Stopwatch start;
  build();
  run.build_s = start.seconds();

  ceres::Solver::Options options = solver_options(settings);
  options.max_num_iterations = max_iterations;
  Watch watch(target_chi2, start, run);
  options.callbacks.push_back(&watch);
  ceres::Solver::Summary summary;
  ceres::Solve(options, problem_.get(), &summary);
  run.final_chi2 = 2.0 * summary.final_cost;
  if (!run.to_optimum_s) run.iterations = static_cast<int>(summary.iterations.size()) - 1;
  return run;
}

bool CeresPoseGraph::solve(CeresSettings settings) {
  ceres::Solver::Options options = solver_options(settings);
  options.max_num_iterations = 200;
  ceres::Solver::Summary summary;
  ceres::Solve(options, problem_.get(), &summary);
  return summary.IsSolutionUsable();
}

Graph CeresPoseGraph::solved() const {
  Graph graph = graph_;
  for (std::size_t i = 0; i < graph.values().pose2.size(); ++i) {
    graph.values().pose2[i] = Se2(pose(i)[0], pose(i)[1], pose(i)[2]);
  }
  for (std::size_t i = 0; i < graph.values().pose3.size(); ++i)
    graph.values().pose3[i] = pose3(pose(i));
  return graph;
}

}  // namespace cairn::bench
