// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/information_scale.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "cairn/diagnostics/components.hpp"
#include "cairn/solver/marginals.hpp"

namespace cairn {
namespace {

constexpr std::size_t kSmallestGroup = 10;
constexpr double kSmallestRedundancy =
    0.02;  // per row: below, chi2 is a quotient of rounding errors
constexpr double kNoiseFree = 1e-10;

// Degrees of freedom per measurement row of the whole graph, in [0, 1].
double mean_redundancy(const Graph& graph) {
  double rows = 0.0, unknowns = 0.0;
  for (const auto& batch : graph.batches())
    rows += static_cast<double>(batch->size()) * batch->residual_dimension();
  std::vector<bool> measured(graph.variables().size(), false);
  for (const FactorRef factor : graph.factors()) {
    for (const VariableSlot slot : graph.slots_of(factor)) measured[slot] = true;
  }
  for (std::size_t s = 0; s < measured.size(); ++s) {
    const Variable& variable = graph.variables()[s];
    if (measured[s] && !variable.fixed) unknowns += tangent_dimension(variable.type);
  }
  for (const Component& component : connected_components(graph)) {
    if (!component.needs_gauge() || !component.smallest_pose) continue;
    unknowns -= tangent_dimension(graph.variables()[*graph.find(*component.smallest_pose)].type);
  }
  return rows > 0.0 ? std::clamp(1.0 - unknowns / rows, 0.0, 1.0) : 0.0;
}

// Expected chi2 of one factor at the optimum if its information is right: d - tr(J Sigma J^T), J
// whitened.
double redundancy(const Graph& graph, FactorRef factor, const EvaluationContext& context,
                  const Marginals& marginals) {
  const FactorEvaluation evaluation =
      graph.batches()[factor.batch]->evaluate(factor.index, context);
  const std::vector<VariableSlot> slots = graph.slots_of(factor);
  const auto& J = evaluation.jacobians;
  const auto d = static_cast<double>(evaluation.residual.size());
  if (slots.size() == 1)
    return d - (J[0] * marginals.covariance(slots[0]) * J[0].transpose()).trace();
  Eigen::MatrixXd J_both(J[0].rows(), J[0].cols() + J[1].cols());
  J_both << J[0], J[1];
  return d - (J_both * marginals.joint_covariance(slots[0], slots[1]) * J_both.transpose()).trace();
}

double median(std::vector<double>& numbers) {
  const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
  std::nth_element(numbers.begin(), middle, numbers.end());
  return *middle;
}

// Median of a chi-square variable with d degrees of freedom, over d (Wilson and Hilferty).
double median_over_mean(int d) { return std::pow(1.0 - 2.0 / (9.0 * d), 3); }

}  // namespace

std::vector<InformationScale> estimate_information_scales(const Graph& graph,
                                                          const Marginals* marginals) {
  std::vector<InformationScale> scales;
  const double mean = mean_redundancy(graph);
  if (mean <= 0.0) return scales;
  const EvaluationContext context{.values = graph.values()};
  for (std::uint32_t b = 0; b < graph.batches().size(); ++b) {
    const FactorBatch& batch = *graph.batches()[b];
    const int d = batch.residual_dimension();
    std::vector<double> chi2(batch.size());
    batch.evaluate_chi2(0, batch.size(), context, chi2.data());
    std::array<std::vector<double>, 3> ratios;  // one per FactorKind
    for (std::uint32_t i = 0; i < batch.size(); ++i) {
      const bool own = marginals != nullptr && batch.signature().size() <= 2;
      const double expected = own ? redundancy(graph, {b, i}, context, *marginals) : mean * d;
      if (!(expected > kSmallestRedundancy * d) || !std::isfinite(chi2[i])) continue;
      ratios[static_cast<std::size_t>(batch.kinds()[i])].push_back(chi2[i] / expected);
    }
    for (std::size_t kind = 0; kind < ratios.size(); ++kind) {
      if (ratios[kind].size() < kSmallestGroup) continue;
      const double ratio = median(ratios[kind]) / median_over_mean(d);
      if (ratio < kNoiseFree) continue;
      scales.push_back(
          {batch.type_name(), static_cast<FactorKind>(kind), ratios[kind].size(), ratio});
    }
  }
  return scales;
}

}  // namespace cairn
