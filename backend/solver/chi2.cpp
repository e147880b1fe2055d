// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/optimize.hpp"

namespace cairn {

double compute_chi2(const Graph& graph, ErrorChart chart) {
  const EvaluationContext context{.values = graph.values(), .chart = chart};
  double chi2 = 0.0;
  for (const auto& batch : graph.batches())
    chi2 += batch->evaluate_cost(0, batch->size(), context).chi2;
  return chi2;
}

}  // namespace cairn
