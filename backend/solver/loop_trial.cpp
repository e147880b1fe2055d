// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/loop_trial.hpp"

#include <algorithm>

#include "cairn/solver/loop_groups.hpp"
#include "cairn/solver/loop_ties.hpp"
#include "cairn/solver/optimize.hpp"

namespace cairn {
namespace {

constexpr std::size_t kLeastLoops = 20;  // that make a noise scale
// In a solution loops have given way to each other: their chi2 is about half of what it was before.
constexpr double kGivenWay = 2.0;

// Whether nothing but these loops ties parts of the graph together.
bool tie_parts(const Graph& graph, const std::vector<std::size_t>& loops) {
  std::vector<LoopTies::Loop> ends;
  for (const std::size_t place : loops) {
    const std::vector<VariableSlot> slots = graph.slots_of(graph.factors()[place]);
    ends.push_back({place, slots.front(), slots.back()});
  }
  LoopTies ties(graph, std::move(ends), loops.size() + 1);
  for (std::size_t i = 0; i < loops.size(); ++i)
    if (!ties.joined(i)) return true;
  return false;
}

// Of every loop, in medians of chi-square.
std::vector<double> loop_ratios(const Graph& graph, const Values& values,
                                const std::vector<bool>& is_new, bool of_new, ErrorChart chart) {
  std::vector<double> ratios;
  for (std::size_t place = 0; place < graph.factor_count(); ++place) {
    const auto [b, index] = graph.factors()[place];
    const FactorBatch& batch = *graph.batches()[b];
    if (batch.kinds()[index] != FactorKind::kLoop || is_new[place] != of_new) continue;
    double chi2 = 0.0;
    batch.evaluate_chi2(index, index + 1, {.values = values, .chart = chart}, &chi2);
    ratios.push_back(chi2 / median_chi2(batch.residual_dimension()));
  }
  return ratios;
}

}  // namespace

LoopTrial try_loops(Graph& graph, const std::vector<std::size_t>& newcomers,
                    const OptimumWithout& before, const SolveOptions& options) {
  LoopTrial trial;
  if (tie_parts(graph, newcomers)) return trial;
  trial.summary = optimize(graph, options);
  if (!trial.summary.usable()) return trial;
  std::vector<bool> is_new(graph.factor_count());
  int dimension = 0;
  for (const std::size_t place : newcomers) {
    is_new[place] = true;
    dimension = graph.batches()[graph.factors()[place].batch]->residual_dimension();
  }
  const std::vector<double> old = loop_ratios(graph, graph.values(), is_new, false, options.chart);
  const std::vector<double> fresh = loop_ratios(graph, graph.values(), is_new, true, options.chart);
  // The sum of many could hide one that is false.
  if (fresh.size() > std::max(kLeastLoops, old.size())) return trial;
  const double scale =
      old.size() < kLeastLoops
          ? 1.0
          : trusted_noise_scale(kGivenWay * median(loop_ratios(graph, before.values, is_new, false,
                                                               options.chart)));
  trial.increase = trial.summary.final_chi2 - before.chi2;
  // One may be as far off as any; the others bring what is to be expected.
  const double others = static_cast<double>(newcomers.size()) - 1.0;
  trial.threshold = scale * (largest_chi2(dimension) + others * dimension);
  const double limit = scale * largest_chi2(dimension) / median_chi2(dimension);
  const auto fits = [limit](double ratio) { return ratio <= limit; };
  trial.passed = trial.increase <= trial.threshold && std::all_of(old.begin(), old.end(), fits) &&
                 std::all_of(fresh.begin(), fresh.end(), fits);
  return trial;
}

}  // namespace cairn
