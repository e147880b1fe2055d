// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/loop_gate.hpp"

#include <algorithm>
#include <optional>
#include <type_traits>
#include <utility>

#include "cairn/solver/loop_clusters.hpp"
#include "cairn/solver/loop_cycles.hpp"
#include "cairn/solver/loop_fit.hpp"
#include "cairn/solver/loop_groups.hpp"
#include "cairn/solver/loop_ties.hpp"
#include "cairn/solver/marginals.hpp"
#include "cairn/solver/optimize.hpp"

namespace cairn {
namespace {

constexpr double kFits = 4;             // medians, of a solution taken without another look
constexpr int kIterationsWithAll = 20;  // more are spent only where loops fit together
constexpr double kSameMinimum = 1e-6;   // of chi2
constexpr int kMostRounds = 16;         // of leaving out, and of taking back
constexpr std::size_t kMostOpponents = 3;
constexpr double kComparisonWork = 2e5;  // multiplications: a group against 300, at most
constexpr int kMostReturns = 2;          // of one loop
constexpr int kMostStarts = 3;

template <class Pose>
class LoopGate {
 public:
  LoopGate(Graph& graph, const SolveOptions& options, const GateOptions& gate)
      : graph_(graph),
        options_(options),
        keep_going_(gate.keep_going),
        cycles_(graph),
        fit_(graph, options.chart),
        ties_(graph, ties_of(graph, cycles_), gate.loops_that_join, gate.frames) {
    options_.loss = {};
    if (options_.eliminations == nullptr) options_.eliminations = &eliminations_;
    if (!keep_going_) return;
    options_.on_iteration = [this, tell = options.on_iteration](int i, const IterationReport& r) {
      return keep_going_() && (!tell || tell(i, r));
    };
  }

  GatedSolution run() {
    if (!take_groups() || !solve_supported()) return finish();
    for (int start = 0; start < kMostStarts; ++start) {
      for (const bool supported : {true, false}) take_back(supported);
      if (!start_again() || !revise()) break;
    }
    return finish();
  }

 private:
  static constexpr int kDimension = UncertainPose<Pose>::kDimension;
  using Loop = typename LoopCycles<Pose>::Loop;

  static std::vector<LoopTies::Loop> ties_of(const Graph& graph, const LoopCycles<Pose>& cycles) {
    std::vector<LoopTies::Loop> ties;
    for (const Loop& loop : cycles.loops())
      ties.push_back({loop.factor, slot(graph, loop.a), slot(graph, loop.b)});
    return ties;
  }
  [[nodiscard]] const std::vector<Loop>& loops() const { return cycles_.loops(); }

  // In medians of chi-square.
  [[nodiscard]] double most() const {
    return largest_chi2(kDimension) / median_chi2(kDimension) * scale_;
  }

  [[nodiscard]] bool work_is_spent() const {
    return options_.work != nullptr && options_.work->spent();
  }
  // Asked before a group is compared with those that follow.
  bool may_go_on() {
    if (options_.work != nullptr) options_.work->spend(kComparisonWork);
    return !work_is_spent() && (!keep_going_ || keep_going_());
  }

  // False where the work is to end.
  bool take_groups() {
    std::optional<LoopGroups> found = find_groups(cycles_, [this] { return may_go_on(); });
    if (!found) {
      result_.summary.stop_reason =
          work_is_spent() ? StopReason::kWorkLimit : StopReason::kInterrupted;
      return false;
    }
    groups_ = std::move(*found);
    in_ = groups_.supported;
    returns_.resize(in_.size());
    shifted_.resize(in_.size());
    for (std::size_t i = 0; i < in_.size(); ++i) ties_parts_.push_back(!ties_.joined(i));
    for (const LoopGroups::Group& group : groups_.groups)
      if (group.in && ties_parts_[group.loops.front()]) in_[group.loops.front()] = true;
    result_.noise_scale = groups_.noise_scale;
    return true;
  }

  // False where there is no solution.
  bool solve_supported() {
    solve_from_start(std::min(kIterationsWithAll, options_.max_iterations));
    if (interrupted()) return false;
    if (result_.summary.usable() && worst_of(ratios()) <= kFits * scale_ &&
        worst_of(lone_ratios()) <= most() && !leave_out_shifted())
      return true;
    leave_out_smaller_half();
    solve_from_start(options_.max_iterations);
    return revise();
  }

  // But of what ties parts together there may be little.
  void leave_out_smaller_half() {
    std::vector<double> sizes;  // by loop
    const auto counts = [this](const LoopGroups::Group& group) {
      return group.in && !ties_parts_[group.loops.front()];
    };
    for (const LoopGroups::Group& group : groups_.groups)
      if (counts(group))
        sizes.insert(sizes.end(), group.loops.size(), static_cast<double>(group.loops.size()));
    if (sizes.empty()) return;
    const double least = median(std::move(sizes));
    for (const LoopGroups::Group& group : groups_.groups)
      if (counts(group) && static_cast<double>(group.loops.size()) < least)
        for (const std::size_t loop : group.loops) in_[loop] = false;
  }

  // Without what does not fit, the worst first, until all does. What has not converged shows what
  // keeps it from that.
  bool revise() {
    for (int round = 0; round < kMostRounds && !interrupted(); ++round) {
      if (!leave_out_worst(ratios()) && !leave_out_worst(lone_ratios()) && !leave_out_shifted())
        break;
      solve(InitMethod::kFile, options_.max_iterations);
    }
    return result_.summary.usable();
  }

  // False where no cluster is.
  bool leave_out_shifted() {
    if (marginals() == nullptr) return false;
    const std::vector<ShiftedLoop> shifted =
        find_shifted_clusters(cycles_, groups_.agreeing, graph_, fit_, in_, *marginals(), scale_);
    for (const ShiftedLoop& cluster : shifted) {
      in_[cluster.loop] = false;
      shifted_[cluster.loop] = cluster;
    }
    return !shifted.empty();
  }

  // False where nothing is too far off.
  bool leave_out_worst(const std::vector<double>& ratios) {
    const double worst = worst_of(ratios);
    if (worst <= most()) return false;
    for (std::size_t i = 0; i < loops().size(); ++i)
      if (in_[i] && ratios[i] > std::max(most(), worst / 4.0)) in_[i] = false;
    return true;
  }

  void take_back(bool supported) {
    for (int round = 0; round < kMostRounds && result_.summary.usable(); ++round) {
      if (!take_back_once(supported)) return;
      solve(InitMethod::kFile, options_.max_iterations);
      if (!revise()) return;
    }
  }

  // What was taken in bit by bit may have led to a minimum beside the best one. True where it had.
  bool start_again() {
    if (!result_.summary.usable() || started_) return false;
    const Values found = graph_.values();
    const SolveSummary summary = result_.summary;
    solve_from_start(options_.max_iterations);
    if (interrupted()) return false;
    const double least = (1.0 - kSameMinimum) * summary.final_chi2;
    if (result_.summary.usable() && result_.summary.final_chi2 <= summary.final_chi2)
      return result_.summary.final_chi2 < least;
    graph_.values() = found;
    result_.summary = summary;
    return false;
  }

  // What agrees with the solution as well as its covariance lets it.
  bool take_back_once(bool supported) {
    bool any = false;
    std::vector<bool> now = in_;
    for (std::size_t i = 0; i < loops().size(); ++i) {
      if (in_[i] || (supported && !groups_.supported[i]) || !ties_.joined(i) ||
          returns_[i] == kMostReturns)
        continue;
      bool agrees = ratio(i) <= most();  // more covariance makes it less
      if (!agrees) {
        if (marginals() == nullptr) return false;
        agrees = fit_.chi2_of_newcomer(loops()[i].factor, *marginals()) <=
                 most() * median_chi2(kDimension);
      }
      now[i] = agrees;
      returns_[i] += agrees;
      any |= agrees;
    }
    in_ = std::move(now);
    return any;
  }

  [[nodiscard]] static VariableSlot slot(const Graph& graph, std::uint32_t pose) {
    constexpr bool kPlane = std::is_same_v<Pose, Se2>;
    return graph.slot_of(kPlane ? VariableType::kPose2 : VariableType::kPose3, pose);
  }

  [[nodiscard]] std::vector<bool> kept() const {
    std::vector<bool> kept(graph_.factor_count(), true);
    for (std::size_t i = 0; i < loops().size(); ++i) kept[loops()[i].factor] = in_[i];
    return kept;
  }

  void solve(InitMethod init, int iterations) {
    ties_.join(in_);
    marginals_.reset();
    started_ = false;
    Graph rest = graph_.with_factors(kept());
    SolveOptions options = options_;
    options.init = init;
    options.max_iterations = iterations;
    result_.summary = optimize(rest, options);
    if (work_is_spent()) {  // a verdict would depend on how far it came
      result_.summary.stop_reason = StopReason::kWorkLimit;
      result_.summary.usable_result = false;
    }
    graph_.values() = rest.values();
  }
  void solve_from_start(int iterations) {
    graph_.values() = start_;
    solve(options_.init, iterations);
    started_ = result_.summary.stop_reason != StopReason::kIterationLimit;
  }
  [[nodiscard]] bool interrupted() const {
    return result_.summary.stop_reason == StopReason::kInterrupted ||
           result_.summary.stop_reason == StopReason::kWorkLimit;
  }

  // Of the solution with what is in; null where the matrix is singular.
  const Marginals* marginals() {
    if (!marginals_) marginals_.emplace(Marginals::compute(graph_.with_factors(kept()), options_));
    return *marginals_ ? &**marginals_ : nullptr;
  }

  // chi2 at the solution over its median, were the information right.
  [[nodiscard]] double ratio(std::size_t loop) const {
    return fit_.chi2(loops()[loop].factor) / median_chi2(kDimension);
  }
  // By loop; of those that are out, 0.
  [[nodiscard]] std::vector<double> ratios() const {
    std::vector<double> all(loops().size(), 0.0);
    for (std::size_t i = 0; i < all.size(); ++i)
      if (in_[i]) all[i] = ratio(i);
    return all;
  }
  // The same against where the solution would be without each one.
  [[nodiscard]] std::vector<double> lone_ratios() {
    std::vector<double> all(loops().size(), 0.0);
    for (std::size_t i = 0; i < all.size() && marginals() != nullptr; ++i)
      if (in_[i])
        all[i] = fit_.chi2_without(loops()[i].factor, *marginals()) / median_chi2(kDimension);
    return all;
  }
  // Of the loops in the solution; and the scale they have by it.
  double worst_of(const std::vector<double>& ratios) {
    std::vector<double> in;
    for (std::size_t i = 0; i < ratios.size(); ++i)
      if (in_[i]) in.push_back(ratios[i]);
    if (in.empty()) return 0.0;
    const double worst = *std::max_element(in.begin(), in.end());
    scale_ = std::max(result_.noise_scale, median(std::move(in)));
    return worst;
  }

  GatedSolution finish() {
    result_.loops = loops().size();
    result_.threshold = largest_chi2(kDimension) * scale_;
    for (std::size_t i = 0; i < loops().size() && result_.summary.usable(); ++i)
      if (!in_[i]) result_.left_out.push_back(judge(i));
    std::sort(result_.left_out.begin(), result_.left_out.end(),
              [](const LeftOutLoop& x, const LeftOutLoop& y) { return x.factor < y.factor; });
    return std::move(result_);
  }

  [[nodiscard]] LeftOutLoop judge(std::size_t i) {
    const Loop& loop = loops()[i];
    if (!ties_.joined(i)) {
      std::vector<bool> candidates = groups_.contradicted;
      candidates.flip();
      return {loop.factor, GateTest::kTooFew, static_cast<double>(ties_.places_like(i, candidates)),
              static_cast<double>(ties_.least())};
    }
    if (const auto& shifted = shifted_[i]; shifted && fit_.chi2(loop.factor) <= result_.threshold)
      return {loop.factor, GateTest::kResidual, shifted->chi2, shifted->chi2 / shifted->excess,
              opponents(i)};
    return {loop.factor, groups_.contradicted[i] ? GateTest::kPairs : GateTest::kResidual,
            ratio(i) * median_chi2(kDimension), result_.threshold, opponents(i)};
  }
  // Of one loop that is in, and whose cycle with this one says that they are not both true.
  [[nodiscard]] std::vector<std::size_t> opponents(std::size_t i) const {
    std::vector<std::pair<int, std::size_t>> found;  // by distance in keyframes
    for (std::size_t k = 0; k < loops().size(); ++k) {
      const Loop& other = loops()[k];
      if (!in_[k] || !cycles_.share_chains(loops()[i], other)) continue;
      const int distance = cycles_.distance(loops()[i], other);
      if (found.size() == kMostOpponents && distance >= found.back().first) continue;
      if (cycles_.chi2(loops()[i], other) <= largest_chi2(kDimension) * result_.noise_scale)
        continue;
      found.insert(std::upper_bound(found.begin(), found.end(), std::pair(distance, other.factor)),
                   {distance, other.factor});
      if (found.size() > kMostOpponents) found.pop_back();
    }
    std::vector<std::size_t> factors;
    for (const auto& [distance, factor] : found) factors.push_back(factor);
    return factors;
  }

  Graph& graph_;
  const Values start_ = graph_.values();
  EliminationCache eliminations_;  // where the options bring none
  SolveOptions options_;
  std::function<bool()> keep_going_;
  LoopCycles<Pose> cycles_;
  LoopFit<Pose> fit_;
  LoopTies ties_;
  LoopGroups groups_;
  std::vector<bool> in_;          // by loop: takes part
  std::vector<bool> ties_parts_;  // by loop: nothing but loops ties its ends together
  bool started_ = false;          // the last solve did, from the beginning, to its end
  std::vector<std::optional<ShiftedLoop>> shifted_;  // by loop: the last time
  std::vector<int> returns_;                         // by loop: how often it was taken back
  std::optional<Result<Marginals>> marginals_;       // of the last solution
  double scale_ = 1.0;                               // of residuals at the solution
  GatedSolution result_;
};

template <class Pose>
GatedSolution gate_loops(Graph& graph, const SolveOptions& options, const GateOptions& gate) {
  return LoopGate<Pose>(graph, options, gate).run();
}

}  // namespace

std::string_view to_string(GateTest test) {
  switch (test) {
    case GateTest::kPairs:
      return "contradicts other loops";
    case GateTest::kResidual:
      return "does not fit the map";
    case GateTest::kTooFew:
      break;
  }
  return "too few loops tie these maps together";
}

static bool has_loops(const Graph& graph, VariableType pose) {
  return std::any_of(graph.batches().begin(), graph.batches().end(), [pose](const auto& batch) {
    const auto kinds = batch->kinds();
    return batch->signature().front() == pose &&
           std::find(kinds.begin(), kinds.end(), FactorKind::kLoop) != kinds.end();
  });
}

// Loops in the plane and loops in space never share a component: one after the other.
GatedSolution solve_gated(Graph& graph, const SolveOptions& options, const GateOptions& gate) {
  const bool in_plane = has_loops(graph, VariableType::kPose2);
  const bool in_space = has_loops(graph, VariableType::kPose3);
  if (!in_space) return gate_loops<Se2>(graph, options, gate);
  GatedSolution solution = gate_loops<Se3>(graph, options, gate);
  if (!in_plane || !solution.summary.usable()) return solution;
  std::vector<std::size_t> place;  // in `graph`, of the factors that are left
  std::vector<bool> kept(graph.factor_count(), true);
  for (const LeftOutLoop& loop : solution.left_out) kept[loop.factor] = false;
  for (std::size_t f = 0; f < kept.size(); ++f)
    if (kept[f]) place.push_back(f);
  Graph rest = graph.with_factors(kept);
  GatedSolution plane = gate_loops<Se2>(rest, options, gate);
  graph.values() = rest.values();
  for (LeftOutLoop& loop : plane.left_out) {
    loop.factor = place[loop.factor];
    for (std::size_t& other : loop.against) other = place[other];
    solution.left_out.push_back(std::move(loop));
  }
  std::sort(solution.left_out.begin(), solution.left_out.end(),
            [](const LeftOutLoop& x, const LeftOutLoop& y) { return x.factor < y.factor; });
  solution.loops += plane.loops;
  solution.threshold = std::max(solution.threshold, plane.threshold);
  solution.summary = plane.summary;
  return solution;
}

}  // namespace cairn
