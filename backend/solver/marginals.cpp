// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/marginals.hpp"

#include <limits>

#include "cairn/linear/selected_inverse.hpp"
#include "cairn/solver/normal_equations.hpp"
#include "cairn/solver/problem.hpp"
#include "cairn/solver/rank.hpp"

namespace cairn {
namespace {

// One, and the selected inverse, which costs two to three times as much.
constexpr double kFactorizations = 4.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// d(Log of T_a_b's change) / d(change of a): Exp(-d) * T_a_b = T_a_b * Exp(-Ad(T_a_b^-1) * d).
template <class Pose>
Eigen::MatrixXd relative_jacobian(const Pose& T_map_a, const Pose& T_map_b) {
  return -(T_map_b.inverse() * T_map_a).adjoint();
}

}  // namespace

struct Marginals::State {
  enum class Standing : char { kUnknown, kHeld, kUnderConstrained };

  std::vector<Variable> variables;
  Values values;
  std::vector<Standing> standing;  ///< by slot
  std::vector<int> block_of_slot;
  BlockPattern pattern;
  std::unique_ptr<LinearSolver> linear;
  std::optional<SelectedInverse> inverse;

  // False when the matrix is singular.
  bool factorize(const NormalEquations& equations) {
    block_of_slot = equations.layout().block_of_slot;
    pattern = equations.pattern();
    linear.reset();
    if (pattern.size() == 0) return true;
    linear = make_multifrontal_solver();
    linear->analyze(pattern, equations.layout().elimination);
    return linear->factorize(equations.values()) &&
           !looks_singular(*linear->factor(), equations.diagonal());
  }

  // As optimize() does: what is free is left out, and the rest is tried again.
  void set_aside(const RankReport& free, Problem& problem) {
    std::vector<bool> dropped(problem.held.size(), false);
    for (const auto& [slot, directions] : free.undetermined) {
      dropped[slot] = true;
      standing[slot] = Standing::kUnderConstrained;
    }
    problem.drop(dropped);
    for (const auto& [slot, directions] : free.anchors) {
      problem.anchors.push_back({slot, directions});
      standing[slot] = Standing::kUnderConstrained;
    }
  }

  [[nodiscard]] int dimension(VariableSlot slot) const {
    return tangent_dimension(variables[slot].type);
  }

  /// Covariance of the changes of a and b; held variables do not change.
  [[nodiscard]] Eigen::MatrixXd block(VariableSlot a, VariableSlot b) const {
    if (standing[a] == Standing::kUnderConstrained || standing[b] == Standing::kUnderConstrained) {
      return Eigen::MatrixXd::Constant(dimension(a), dimension(b), kNan);
    }
    if (standing[a] == Standing::kHeld || standing[b] == Standing::kHeld) {
      return Eigen::MatrixXd::Zero(dimension(a), dimension(b));
    }
    const int row = pattern.scalar_begin[block_of_slot[a]];
    const int column = pattern.scalar_begin[block_of_slot[b]];
    // Blocks are in the factor's pattern as a whole or not at all.
    if (!inverse->find(row, column)) return solve_block(a, b);
    Eigen::MatrixXd covariance(dimension(a), dimension(b));
    for (int j = 0; j < covariance.cols(); ++j) {
      for (int i = 0; i < covariance.rows(); ++i)
        covariance(i, j) = *inverse->find(row + i, column + j);
    }
    return covariance;
  }

  /// By the change of the first, then of the second pose, of T_a_b.
  [[nodiscard]] Eigen::MatrixXd relative_jacobian_of(VariableSlot a, VariableSlot b) const {
    const Variable &of_a = variables[a], &of_b = variables[b];
    CAIRN_CHECK(is_pose(of_a.type) && of_a.type == of_b.type,
                "relative covariance is of two poses of one type");
    const int d = tangent_dimension(of_a.type);
    Eigen::MatrixXd J(d, 2 * d);
    J.rightCols(d).setIdentity();
    J.leftCols(d) = of_a.type == VariableType::kPose2
                        ? relative_jacobian(values.pose2[of_a.index], values.pose2[of_b.index])
                        : relative_jacobian(values.pose3[of_a.index], values.pose3[of_b.index]);
    return J;
  }

  /// Adds J^T for a pair: all rows, a column for each of J.
  void add_columns(std::pair<VariableSlot, VariableSlot> pair, const Eigen::MatrixXd& J,
                   Eigen::MatrixXd& columns) const {
    const int d = dimension(pair.first);
    for (const bool first : {true, false}) {
      const VariableSlot slot = first ? pair.first : pair.second;
      if (standing[slot] == Standing::kUnknown)
        columns.middleRows(pattern.scalar_begin[block_of_slot[slot]], d) +=
            (first ? J.leftCols(d) : J.rightCols(d)).transpose();
    }
  }
  void solve(Eigen::MatrixXd& columns) const {
    for (Eigen::Index j = 0; j < columns.cols() && linear; ++j)
      linear->solve(columns.col(j).data(), columns.col(j).data());
  }
  /// The rows of both poses of a pair; of held ones zero, of under-constrained ones NaN.
  [[nodiscard]] Eigen::MatrixXd rows_of(std::pair<VariableSlot, VariableSlot> pair,
                                        const Eigen::MatrixXd& columns) const {
    const int d = dimension(pair.first);
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(2 * d, columns.cols());
    for (const bool first : {true, false}) {
      const VariableSlot slot = first ? pair.first : pair.second;
      auto half = rows.middleRows(first ? 0 : d, d);
      if (standing[slot] == Standing::kUnknown)
        half = columns.middleRows(pattern.scalar_begin[block_of_slot[slot]], d);
      else if (standing[slot] == Standing::kUnderConstrained)
        half.setConstant(kNan);
    }
    return rows;
  }

  /// The same from columns of the inverse, one solve each.
  [[nodiscard]] Eigen::MatrixXd solve_block(VariableSlot a, VariableSlot b) const {
    Eigen::MatrixXd covariance(dimension(a), dimension(b));
    Eigen::VectorXd column(pattern.scalar_size());
    for (int j = 0; j < covariance.cols(); ++j) {
      column.setZero();
      column[pattern.scalar_begin[block_of_slot[b]] + j] = 1.0;
      linear->solve(column.data(), column.data());
      covariance.col(j) = column.segment(pattern.scalar_begin[block_of_slot[a]], covariance.rows());
    }
    return covariance;
  }
};

Marginals::Marginals(std::unique_ptr<State> state) : state_(std::move(state)) {}
Marginals::Marginals(Marginals&&) noexcept = default;
Marginals& Marginals::operator=(Marginals&&) noexcept = default;
Marginals::~Marginals() = default;

Result<Marginals> Marginals::compute(const Graph& graph, const SolveOptions& options) {
  auto state = std::make_unique<State>();
  state->variables.assign(graph.variables().begin(), graph.variables().end());
  state->values = graph.values();
  Problem problem(graph);
  state->standing.assign(problem.held.size(), State::Standing::kUnknown);
  for (std::size_t slot = 0; slot < problem.held.size(); ++slot) {
    if (problem.held[slot]) state->standing[slot] = State::Standing::kHeld;
  }
  const EvaluationContext context{graph.values(), options.chart, options.loss,
                                  options.loss_on_loops_only};
  ThreadPool pool(options.threads);
  while (true) {
    const UnknownLayout layout(problem, options.eliminations);
    if (options.work != nullptr) options.work->spend(kFactorizations * layout.iteration_work);
    NormalEquations equations(problem, layout);
    if (!std::isfinite(equations.linearize(context, pool).cost)) {
      return Error{ErrorCode::kNotUsable,
                   "the cost is not finite at these estimates, so they have no covariance"};
    }
    if (state->factorize(equations)) break;
    const RankReport free = find_free_directions(equations);
    if (free.full_rank()) {
      return Error{ErrorCode::kNotUsable,
                   "the measurements hardly determine the estimates: no covariance to 1e-13"};
    }
    state->set_aside(free, problem);
  }
  if (state->linear) state->inverse.emplace(*state->linear->factor());
  return Marginals(std::move(state));
}

Eigen::MatrixXd Marginals::covariance(VariableSlot variable) const {
  return state_->block(variable, variable);
}

Eigen::MatrixXd Marginals::joint_covariance(VariableSlot a, VariableSlot b) const {
  const int d_a = state_->dimension(a), d_b = state_->dimension(b);
  Eigen::MatrixXd joint(d_a + d_b, d_a + d_b);
  joint.topLeftCorner(d_a, d_a) = state_->block(a, a);
  joint.bottomRightCorner(d_b, d_b) = state_->block(b, b);
  joint.topRightCorner(d_a, d_b) = state_->block(a, b);
  joint.bottomLeftCorner(d_b, d_a) = joint.topRightCorner(d_a, d_b).transpose();
  return joint;
}

Eigen::MatrixXd Marginals::relative_covariance(VariableSlot a, VariableSlot b) const {
  const Eigen::MatrixXd J = state_->relative_jacobian_of(a, b);
  if (a == b) return Eigen::MatrixXd::Zero(J.rows(), J.rows());
  return J * joint_covariance(a, b) * J.transpose();
}

Eigen::MatrixXd Marginals::relative_covariance(
    std::span<const std::pair<VariableSlot, VariableSlot>> pairs) const {
  const auto count = static_cast<Eigen::Index>(pairs.size());
  const Eigen::Index d = pairs.empty() ? 0 : state_->dimension(pairs.front().first);
  std::vector<Eigen::MatrixXd> J;
  for (const auto& [a, b] : pairs) J.push_back(state_->relative_jacobian_of(a, b));
  Eigen::MatrixXd covariance(count * d, count * d);
  for (Eigen::Index x = 0; x < count; ++x) {
    Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(state_->pattern.scalar_size(), d);
    state_->add_columns(pairs[x], J[x], moved);
    state_->solve(moved);
    for (Eigen::Index y = 0; y < count; ++y)
      covariance.block(y * d, x * d, d, d) = J[y] * state_->rows_of(pairs[y], moved);
  }
  return 0.5 * (covariance + covariance.transpose());
}

Eigen::MatrixXd Marginals::covariance_of_sum(
    std::span<const std::pair<VariableSlot, VariableSlot>> pairs,
    std::span<const Eigen::MatrixXd> weights) const {
  const Eigen::Index sums = weights.empty() ? 0 : weights.front().cols();
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(state_->pattern.scalar_size(), sums);
  std::vector<Eigen::MatrixXd> J;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    J.push_back(weights[i].transpose() *
                state_->relative_jacobian_of(pairs[i].first, pairs[i].second));
    state_->add_columns(pairs[i], J.back(), columns);
  }
  state_->solve(columns);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(sums, sums);
  for (std::size_t i = 0; i < pairs.size(); ++i)
    covariance += J[i] * state_->rows_of(pairs[i], columns);
  return 0.5 * (covariance + covariance.transpose());
}

}  // namespace cairn
