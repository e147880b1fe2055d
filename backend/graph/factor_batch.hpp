// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "cairn/graph/robust_loss.hpp"
#include "cairn/graph/variable.hpp"

namespace cairn {

/// The rotation part of SE(3) errors (backend/geometry/README.md, "error charts").
enum class ErrorChart : std::uint8_t { kG2o, kLog, kGtsam };

/// What linearize() and evaluate() need beside the factors.
struct EvaluationContext {
  const Values& values;
  ErrorChart chart = ErrorChart::kG2o;
  RobustLoss loss{};
  bool loss_on_loops_only = false;

  [[nodiscard]] bool robust(FactorKind kind) const {
    return loss.kind() != RobustLoss::Kind::kNone &&
           (!loss_on_loops_only || kind == FactorKind::kLoop);
  }
};

/// Sums over a range of factors.
struct RangeCost {
  double chi2 = 0.0;  ///< sum of e^T Omega e, never robustified, never halved
  double cost = 0.0;  ///< half the sum of rho(e^T Omega e)
};

/// Where the blocks of the normal equations of one batch land. With K variables per factor, in
/// signature order: factor i writes H_kk (column-major d_k x d_k) followed by g_k = J_k^T Omega e
/// (d_k numbers) at `diagonal + diagonal_offset[i * K + k]`, and for each pair k < l, in the order
/// (0,1), (0,2), (1,2), the block H_kl at `blocks + off_diagonal[...].offset`. Each factor has
/// places of its own, so ranges may run in parallel.
struct NormalEquationTargets {
  static constexpr std::size_t kSkip =
      ~std::size_t{0};  ///< the variable (or one of the pair) is held fixed

  struct OffDiagonal {
    std::size_t offset = kSkip;
    std::int32_t leading_dimension = 0;
    bool transposed = false;  ///< store H_kl^T = H_lk
  };

  double* diagonal = nullptr;
  const std::size_t* diagonal_offset = nullptr;
  double* blocks = nullptr;
  const OffDiagonal* off_diagonal = nullptr;
};

/// Everything about one factor at the given values, for tests, other solvers and diagnostics. Not
/// for inner loops.
struct FactorEvaluation {
  Eigen::VectorXd residual;  ///< whitened: |residual|^2 = e^T Omega e
  std::vector<Eigen::MatrixXd>
      jacobians;  ///< d residual / d tangent, one per variable of the signature
};

/// A relative pose T_a_b and how well it is known, isotropically; input of the initialization.
template <class Pose>
struct RelativePose {
  std::uint32_t a, b;  ///< indices into Values::pose2 or Values::pose3
  Pose T_a_b;
  double translation_weight;  ///< 1/m^2
  double rotation_weight;     ///< 1/rad^2
};

/// A contiguous array of factors of one type. The solver knows factors only through this interface:
/// one virtual call per range, arrays inside.
class FactorBatch {
 public:
  virtual ~FactorBatch() = default;
  [[nodiscard]] virtual std::unique_ptr<FactorBatch> clone() const = 0;
  /// A batch of some of the factors, on the same variables.
  [[nodiscard]] virtual std::unique_ptr<FactorBatch> select(
      std::span<const std::uint32_t> factors) const = 0;

  [[nodiscard]] virtual std::string_view type_name() const = 0;
  [[nodiscard]] virtual std::span<const VariableType> signature() const = 0;
  [[nodiscard]] virtual int residual_dimension() const = 0;
  /// True when the factor ties its variables to the map frame (prior, GNSS, ...): such a component
  /// needs no gauge.
  [[nodiscard]] virtual bool is_absolute() const = 0;

  [[nodiscard]] std::size_t size() const { return kinds_.size(); }
  /// Row-major size() x signature().size(): indices into the Values arrays of the signature's
  /// types.
  [[nodiscard]] std::span<const std::uint32_t> variable_indices() const {
    return variable_indices_;
  }
  [[nodiscard]] std::span<const FactorKind> kinds() const { return kinds_; }
  void set_kind(std::size_t factor, FactorKind kind) { kinds_[factor] = kind; }

  /// Sums over factors [begin, end), in order.
  [[nodiscard]] virtual RangeCost evaluate_cost(std::size_t begin, std::size_t end,
                                                const EvaluationContext& context) const = 0;
  /// As evaluate_cost, and writes the normal equations of these factors to their targets.
  virtual RangeCost linearize(std::size_t begin, std::size_t end, const EvaluationContext& context,
                              const NormalEquationTargets& targets) const = 0;
  /// One factor, whitened, without loss.
  [[nodiscard]] virtual FactorEvaluation evaluate(std::size_t factor,
                                                  const EvaluationContext& context) const = 0;
  /// As evaluate, into arrays and without allocation: `jacobians[k]` is column-major
  /// residual_dimension() x tangent dimension of variable k. `jacobians` or any entry of it may be
  /// null.
  virtual void evaluate_into(std::size_t factor, const EvaluationContext& context, double* residual,
                             double* const* jacobians) const = 0;
  /// Per-factor e^T Omega e for [begin, end) into `chi2`.
  virtual void evaluate_chi2(std::size_t begin, std::size_t end, const EvaluationContext& context,
                             double* chi2) const = 0;

  /// The measured relative poses, for types that measure them between two poses; empty otherwise.
  [[nodiscard]] virtual std::vector<RelativePose<Se2>> relative_poses2() const { return {}; }
  [[nodiscard]] virtual std::vector<RelativePose<Se3>> relative_poses3() const { return {}; }
  /// Where the last variable would be if the others are right (a landmark from its first sighting),
  /// into `values`. False when one factor does not tell.
  virtual bool predict_last(std::size_t /*factor*/, Values& /*values*/) const { return false; }

 protected:
  FactorBatch() = default;
  FactorBatch(const FactorBatch&) = default;
  FactorBatch& operator=(const FactorBatch&) = default;

  std::vector<std::uint32_t> variable_indices_;
  std::vector<FactorKind> kinds_;
};

}  // namespace cairn
