// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/replay/quick_gate.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "cairn/factors/factor_codec.hpp"
#include "cairn/solver/loop_cycles.hpp"
#include "cairn/solver/loop_trial.hpp"
#include "cairn/solver/optimize.hpp"

namespace cairn {
namespace {

// What estimates that a solve has left and odometry has grown may cost by rounding.
constexpr double kNothing = 1e-6;

Values estimates_of(const PoseGraph& map, const CanonicalOrder& order, const Graph& graph) {
  Graph at;
  for (std::size_t place = 0; place < order.nodes.size(); ++place) {
    const VariableType type = map.nodes[order.nodes[place]].type;
    const double* numbers = map.estimates[order.nodes[place]].data();
    if (!add_variable(at, VariableId{place}, type, {numbers, numbers + value_numbers(type)}))
      return graph.values();
  }
  return at.values();
}

// Of the factors at places in the order for which `counts`.
template <class Counts>
double chi2_of(const Graph& graph, const Values& values, Counts counts) {
  double sum = 0.0;
  for (std::size_t i = 0; i < graph.factor_count(); ++i) {
    if (!counts(i)) continue;
    const auto [batch, index] = graph.factors()[i];
    double chi2 = 0.0;
    graph.batches()[batch]->evaluate_chi2(index, index + 1, {values}, &chi2);
    sum += chi2;
  }
  return sum;
}

// That of the map's estimates, where they are one.
OptimumWithout optimum_without(const PoseGraph& map, const CanonicalOrder& order,
                               const Graph& graph, const std::vector<bool>& is_old,
                               const SettleOptions& options) {
  Values estimates = estimates_of(map, order, graph);
  const double unsolved = chi2_of(graph, estimates, [&](std::size_t i) {
    return is_old[i] && order.factors[i] >= map.first_unsolved_factor;
  });
  if (unsolved <= kNothing) {
    const double chi2 = chi2_of(graph, estimates, [&](std::size_t i) { return is_old[i]; });
    return {chi2, std::move(estimates)};
  }
  Graph old = graph.with_factors(is_old);
  const double chi2 = optimize(old, optimizer_options(options)).final_chi2;
  return {chi2, old.values()};
}

bool is_out(const StoredFactor& factor) { return factor.state == FactorState::kQuarantined; }

bool any_is_out(const PoseGraph& map) {
  for (std::size_t f = 0; f < map.factors.size(); ++f)
    if (is_out(map.factors[f])) return true;
  return false;
}

// One that is out, and by its own error could well be in: not one at the limit, about which the
// whole gate, whose noise scale is a little different, would be asked again and again.
bool another_fits(const PoseGraph& map, const SettledEstimate& settled, double threshold) {
  const CanonicalOrder out(map, [&](std::uint32_t f) { return is_out(map.factors[f]); });
  const Graph graph = canonical_graph(map, out);
  for (const FactorRef factor : graph.factors()) {
    double chi2 = 0.0;
    graph.batches()[factor.batch]->evaluate_chi2(factor.index, factor.index + 1,
                                                 {settled.graph.values()}, &chi2);
    if (chi2 <= threshold / 2.0) return true;
  }
  return false;
}

// A newcomer that fits agrees with one that is out: evidence for that one has grown.
template <class Pose>
bool supports_one(const Graph& graph, const std::vector<FactorState>& states, double threshold) {
  const LoopCycles<Pose> cycles(graph);
  const auto of_state = [&](FactorState state) {
    std::vector<typename LoopCycles<Pose>::Loop> loops;
    for (const auto& loop : cycles.loops())
      if (states[loop.factor] == state) loops.push_back(loop);
    return loops;
  };
  const auto out = of_state(FactorState::kQuarantined);
  for (const auto& newcomer : of_state(FactorState::kPending))
    for (const auto& loop : out)
      if (cycles.share_chains(newcomer, loop) && cycles.distance(newcomer, loop) <= kReach &&
          cycles.chi2(newcomer, loop) <= threshold)
        return true;
  return false;
}

template <class IsNew>
bool evidence_grows(const PoseGraph& map, IsNew is_new, double threshold) {
  const CanonicalOrder order(map, [&](std::uint32_t f) {
    return takes_part(map.factors[f].state) || is_new(f) || is_out(map.factors[f]);
  });
  std::vector<FactorState> states;
  for (const std::uint32_t f : order.factors) states.push_back(map.factors[f].state);
  const Graph graph = canonical_graph(map, order);
  return supports_one<Se2>(graph, states, threshold) || supports_one<Se3>(graph, states, threshold);
}

}  // namespace

std::optional<SettledEstimate> try_newcomers(const PoseGraph& map, const SettleOptions& options) {
  if (map.switched_since_solve) return std::nullopt;  // verdicts may stand on what is gone
  const auto is_new = [&](std::uint32_t f) {
    return map.factors[f].state == FactorState::kPending && f >= map.first_unsolved_factor;
  };
  SettledEstimate settled;
  settled.order = CanonicalOrder(
      map, [&](std::uint32_t f) { return takes_part(map.factors[f].state) || is_new(f); });
  settled.graph = canonical_graph(map, settled.order);
  std::vector<bool> is_old;
  std::vector<std::size_t> newcomers;
  for (std::size_t i = 0; i < settled.order.factors.size(); ++i) {
    is_old.push_back(!is_new(settled.order.factors[i]));
    if (!is_old.back()) newcomers.push_back(i);
  }
  if (newcomers.empty()) {
    settled.summary = optimize(settled.graph, optimizer_options(options));
    return settled;
  }
  const OptimumWithout before = optimum_without(map, settled.order, settled.graph, is_old, options);
  LoopTrial trial = try_loops(settled.graph, newcomers, before, optimizer_options(options));
  if (trial.summary.stop_reason != StopReason::kInterrupted &&
      (!trial.passed || (any_is_out(map) && (another_fits(map, settled, trial.threshold) ||
                                             evidence_grows(map, is_new, trial.threshold)))))
    return std::nullopt;
  settled.summary = std::move(trial.summary);
  for (const std::size_t i : newcomers)
    settled.verdicts.push_back({settled.order.factors[i], FactorState::kCommitted, "fits at once",
                                trial.increase, trial.threshold});
  return settled;
}

}  // namespace cairn
