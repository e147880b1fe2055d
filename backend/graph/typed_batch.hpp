// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "cairn/geometry/information.hpp"
#include "cairn/graph/factor_batch.hpp"

namespace cairn {

/// The variable types of a factor, in the order its error function takes them.
template <VariableType... kTypes>
struct Signature {
  static constexpr std::array kArray{kTypes...};
  static constexpr std::size_t kArity = sizeof...(kTypes);
};

/// What a factor type F provides (all a new factor needs):
///   static constexpr std::string_view kName;
///   using Variables = Signature<VariableType::kPose2, ...>;
///   static constexpr int kDimension;                 // of the error
///   static constexpr bool kAbsolute;                 // see FactorBatch::is_absolute
///   Eigen::Matrix<double, kDimension, kDimension> information;
///   Error error(const Values&..., ErrorChart, Jacobian*...) const;   // unwhitened e; each J_e_x
///   may be null
/// Optional:
///   Matrix information_in(ErrorChart) const;         // where the chart rescales the information
///   RelativePose<Pose> relative_pose(a, b) const;
///   bool predict_last(const Values&..., Value& last) const;
/// Optional, hand-written and fast, for the g2o chart only; equal to what error() leads to up to
/// rounding:
///   static void squared_errors(const TypedBatch<F>&, begin, end, const Values&, double* out);
///   static RangeCost linearize(const TypedBatch<F>&, begin, end, const EvaluationContext&, const
///   NormalEquationTargets&);
template <class F>
class TypedBatch final : public FactorBatch {
 public:
  using Variables = typename F::Variables;
  static constexpr std::size_t kArity = Variables::kArity;
  static constexpr int kDimension = F::kDimension;
  using ErrorVector = Eigen::Matrix<double, kDimension, 1>;
  using InformationMatrix = Eigen::Matrix<double, kDimension, kDimension>;

  void add(const F& factor, const std::array<std::uint32_t, kArity>& indices, FactorKind kind) {
    factors_.push_back(factor);
    variable_indices_.insert(variable_indices_.end(), indices.begin(), indices.end());
    kinds_.push_back(kind);
  }
  void reserve(std::size_t count) {
    factors_.reserve(count);
    variable_indices_.reserve(count * kArity);
    kinds_.reserve(count);
  }
  [[nodiscard]] const F& factor(std::size_t i) const { return factors_[i]; }
  [[nodiscard]] F& factor(std::size_t i) { return factors_[i]; }
  [[nodiscard]] std::span<const F> factors() const { return factors_; }

  [[nodiscard]] std::unique_ptr<FactorBatch> clone() const override {
    return std::make_unique<TypedBatch>(*this);
  }
  [[nodiscard]] std::unique_ptr<FactorBatch> select(
      std::span<const std::uint32_t> chosen) const override {
    auto selection = std::make_unique<TypedBatch>();
    for (const std::uint32_t i : chosen) {
      std::array<std::uint32_t, kArity> indices;
      for (std::size_t k = 0; k < kArity; ++k) indices[k] = variable_indices_[i * kArity + k];
      selection->add(factors_[i], indices, kinds_[i]);
    }
    return selection;
  }
  [[nodiscard]] std::string_view type_name() const override { return F::kName; }
  [[nodiscard]] std::span<const VariableType> signature() const override {
    return Variables::kArray;
  }
  [[nodiscard]] int residual_dimension() const override { return kDimension; }
  [[nodiscard]] bool is_absolute() const override { return F::kAbsolute; }

  [[nodiscard]] RangeCost evaluate_cost(std::size_t begin, std::size_t end,
                                        const EvaluationContext& context) const override {
    RangeCost sum;
    std::array<double, 64> chi2;
    for (std::size_t i = begin; i < end;) {
      const std::size_t stop = std::min(end, i + chi2.size());
      evaluate_chi2(i, stop, context, chi2.data());
      for (const double* s = chi2.data(); i < stop; ++i, ++s) {
        sum.chi2 += *s;
        sum.cost += 0.5 * (context.robust(kinds_[i]) ? context.loss.evaluate(*s).rho : *s);
      }
    }
    return sum;
  }

  void evaluate_chi2(std::size_t begin, std::size_t end, const EvaluationContext& context,
                     double* out) const override {
    if constexpr (requires { F::squared_errors(*this, begin, end, context.values, out); }) {
      if (context.chart == ErrorChart::kG2o)
        return F::squared_errors(*this, begin, end, context.values, out);
    }
    for (std::size_t i = begin; i < end; ++i) {
      const ErrorVector e = error(i, context);
      *out++ = e.dot(information(i, context.chart) * e);
    }
  }

  RangeCost linearize(std::size_t begin, std::size_t end, const EvaluationContext& context,
                      const NormalEquationTargets& targets) const override {
    if constexpr (requires { F::linearize(*this, begin, end, context, targets); }) {
      if (context.chart == ErrorChart::kG2o)
        return F::linearize(*this, begin, end, context, targets);
    }
    RangeCost sum;
    for (std::size_t i = begin; i < end; ++i) {
      linearize_one(i, context, targets, sum, std::make_index_sequence<kArity>());
    }
    return sum;
  }

  [[nodiscard]] FactorEvaluation evaluate(std::size_t i,
                                          const EvaluationContext& context) const override {
    return evaluate_one(i, context, std::make_index_sequence<kArity>());
  }

  void evaluate_into(std::size_t i, const EvaluationContext& context, double* residual,
                     double* const* jacobians) const override {
    evaluate_one_into(i, context, residual, jacobians, std::make_index_sequence<kArity>());
  }

  [[nodiscard]] std::vector<RelativePose<Se2>> relative_poses2() const override {
    return relative_poses<Se2>();
  }
  [[nodiscard]] std::vector<RelativePose<Se3>> relative_poses3() const override {
    return relative_poses<Se3>();
  }
  bool predict_last(std::size_t i, Values& values) const override {
    return predict_last_one(i, values, std::make_index_sequence<kArity - 1>());
  }

 private:
  template <std::size_t k>
  using Value = typename VariableTraits<Variables::kArray[k]>::Value;
  template <std::size_t k>
  static constexpr int kTangent = tangent_dimension(Variables::kArray[k]);
  template <std::size_t k>
  using Jacobian = Eigen::Matrix<double, kDimension, kTangent<k>>;

  template <std::size_t k>
  const Value<k>& value(std::size_t i, const Values& values) const {
    return (values.*
            VariableTraits<Variables::kArray[k]>::kArray)[variable_indices_[i * kArity + k]];
  }

  [[nodiscard]] InformationMatrix information(std::size_t i, ErrorChart chart) const {
    if constexpr (requires(const F& f) { f.information_in(chart); }) {
      return factors_[i].information_in(chart);
    } else {
      return factors_[i].information;
    }
  }

  [[nodiscard]] ErrorVector error(std::size_t i, const EvaluationContext& context) const {
    return [&]<std::size_t... k>(std::index_sequence<k...>) {
      return factors_[i].error(value<k>(i, context.values)..., context.chart,
                               static_cast<Jacobian<k>*>(nullptr)...);
    }(std::make_index_sequence<kArity>());
  }

  template <std::size_t... k>
  FactorEvaluation evaluate_one(std::size_t i, const EvaluationContext& context,
                                std::index_sequence<k...>) const {
    std::tuple<Jacobian<k>...> J;
    const ErrorVector e =
        factors_[i].error(value<k>(i, context.values)..., context.chart, &std::get<k>(J)...);
    const InformationMatrix U = sqrt_information<kDimension>(information(i, context.chart));
    return {U * e, {Eigen::MatrixXd(U * std::get<k>(J))...}};
  }

  template <std::size_t... k>
  void evaluate_one_into(std::size_t i, const EvaluationContext& context, double* residual,
                         double* const* jacobians, std::index_sequence<k...>) const {
    const InformationMatrix U = sqrt_information<kDimension>(information(i, context.chart));
    Eigen::Map<ErrorVector> r(residual);
    if (!jacobians) {
      r.noalias() = U.lazyProduct(error(i, context));
      return;
    }
    std::tuple<Jacobian<k>...> J;
    r.noalias() = U.lazyProduct(
        factors_[i].error(value<k>(i, context.values)..., context.chart, &std::get<k>(J)...));
    const auto whiten = [&](double* out, const auto& J_e_x) {
      using Matrix = std::remove_cvref_t<decltype(J_e_x)>;
      if (out) Eigen::Map<Matrix>(out).noalias() = U.lazyProduct(J_e_x);
    };
    (whiten(jacobians[k], std::get<k>(J)), ...);
  }

  // H_kl = J_k^T (w Omega) J_l and g_k = J_k^T (w Omega) e, written to the factor's own places.
  template <std::size_t... k>
  void linearize_one(std::size_t i, const EvaluationContext& context,
                     const NormalEquationTargets& targets, RangeCost& sum,
                     std::index_sequence<k...>) const {
    std::tuple<Jacobian<k>...> J;
    const ErrorVector e =
        factors_[i].error(value<k>(i, context.values)..., context.chart, &std::get<k>(J)...);
    InformationMatrix omega = information(i, context.chart);
    const double s = e.dot(omega * e);
    sum.chi2 += s;
    if (context.robust(kinds_[i])) {
      const RobustLoss::Value loss = context.loss.evaluate(s);
      sum.cost += 0.5 * loss.rho;
      omega *= loss.weight;
    } else {
      sum.cost += 0.5 * s;
    }
    const std::tuple<Jacobian<k>...> WJ{(omega * std::get<k>(J))...};
    (write_diagonal<k>(targets, i, std::get<k>(J), std::get<k>(WJ), e), ...);
    if constexpr (kArity >= 2) write_off_diagonal<0, 1>(targets, i, J, WJ);
    if constexpr (kArity >= 3) {
      write_off_diagonal<0, 2>(targets, i, J, WJ);
      write_off_diagonal<1, 2>(targets, i, J, WJ);
    }
    static_assert(kArity <= 3);
  }

  template <std::size_t k>
  void write_diagonal(const NormalEquationTargets& targets, std::size_t i, const Jacobian<k>& J,
                      const Jacobian<k>& WJ, const ErrorVector& e) const {
    constexpr int d = kTangent<k>;
    const std::size_t offset = targets.diagonal_offset[i * kArity + k];
    if (offset == NormalEquationTargets::kSkip) return;
    Eigen::Map<Eigen::Matrix<double, d, d>>(targets.diagonal + offset).noalias() =
        J.transpose().lazyProduct(WJ);
    Eigen::Map<Eigen::Matrix<double, d, 1>>(targets.diagonal + offset + d * d).noalias() =
        WJ.transpose().lazyProduct(e);
  }

  template <std::size_t k, std::size_t l, class Tuple>
  void write_off_diagonal(const NormalEquationTargets& targets, std::size_t i, const Tuple& J,
                          const Tuple& WJ) const {
    constexpr std::size_t kPairs = kArity * (kArity - 1) / 2;
    const auto& target = targets.off_diagonal[i * kPairs + k + l - 1];
    if (target.offset == NormalEquationTargets::kSkip) return;
    using Stride = Eigen::OuterStride<>;
    double* block = targets.blocks + target.offset;
    if (target.transposed) {
      Eigen::Map<Eigen::Matrix<double, kTangent<l>, kTangent<k>>, 0, Stride>(
          block, Stride(target.leading_dimension))
          .noalias() = std::get<l>(WJ).transpose().lazyProduct(std::get<k>(J));
    } else {
      Eigen::Map<Eigen::Matrix<double, kTangent<k>, kTangent<l>>, 0, Stride>(
          block, Stride(target.leading_dimension))
          .noalias() = std::get<k>(J).transpose().lazyProduct(std::get<l>(WJ));
    }
  }

  template <class Pose>
  [[nodiscard]] std::vector<RelativePose<Pose>> relative_poses() const {
    std::vector<RelativePose<Pose>> poses;
    if constexpr (requires(const F& f) {
                    { f.relative_pose(0u, 1u) } -> std::same_as<RelativePose<Pose>>;
                  }) {
      poses.reserve(size());
      for (std::size_t i = 0; i < size(); ++i) {
        poses.push_back(
            factors_[i].relative_pose(variable_indices_[2 * i], variable_indices_[2 * i + 1]));
      }
    }
    return poses;
  }

  template <std::size_t... k>
  bool predict_last_one(std::size_t i, Values& values, std::index_sequence<k...>) const {
    constexpr std::size_t kLast = kArity - 1;
    auto& last =
        (values.*
         VariableTraits<Variables::kArray[kLast]>::kArray)[variable_indices_[i * kArity + kLast]];
    if constexpr (requires(const F& f) { f.predict_last(value<k>(i, values)..., last); }) {
      return factors_[i].predict_last(value<k>(i, values)..., last);
    } else {
      return false;
    }
  }

  std::vector<F> factors_;
};

}  // namespace cairn
