// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/loop_gate.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>
#include <utility>

#include "cairn/solver/loop_cycles.hpp"
#include "cairn/solver/marginals.hpp"
#include "cairn/solver/optimize.hpp"

namespace cairn {
namespace {

constexpr int kReach = 10;  // keyframes between the ends of loops that can support each other
constexpr double kTolerance = 42;     // thresholds, in medians of chi-square times the noise scale
constexpr double kFits = 4;           // the same for a solution that is taken without another look
constexpr double kLeastScale = 1e-3;  // noise-free data would refuse its own rounding errors
constexpr std::size_t kLeastPairs = 20;  // that make a noise scale
constexpr int kIterationsWithAll = 20;   // more are spent only where loops fit together
constexpr int kMostRounds = 8;           // of leaving out, and of taking back

// Wilson and Hilferty 1931.
double median_chi2(int dimension) {
  const double d = dimension;
  return d * std::pow(1.0 - 2.0 / (9.0 * d), 3);
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

template <class Pose>
class LoopGate {
 public:
  LoopGate(Graph& graph, const SolveOptions& options)
      : graph_(graph),
        options_(options),
        cycles_(graph),
        in_(cycles_.loops().size()),
        contradicted_(in_.size()) {
    options_.loss = {};
  }

  GatedSolution run() {
    find_support();
    group();
    drop_contradicting();
    if (!solve_supported()) return finish();
    for (const bool supported : {true, false}) take_back(supported);
    start_again();
    return finish();
  }

 private:
  static constexpr int kDimension = UncertainPose<Pose>::kDimension;
  using Loop = typename LoopCycles<Pose>::Loop;
  struct Pair {
    std::size_t x, y;
    double chi2;
  };
  struct Group {
    std::vector<std::size_t> loops;  // the first stands for all
    bool in = true;
  };

  [[nodiscard]] const std::vector<Loop>& loops() const { return cycles_.loops(); }
  [[nodiscard]] double unit() const { return median_chi2(kDimension) * result_.noise_scale; }

  // Which nearby loops agree, in units that come from all such pairs.
  void find_support() {
    for (std::size_t x = 0; x < loops().size(); ++x) {
      for (std::size_t y = x + 1; y < loops().size(); ++y) {
        const Loop &first = loops()[x], &second = loops()[y];
        if (!cycles_.share_chains(first, second) || cycles_.places_apart(first, second) > kReach)
          break;
        const int distance = cycles_.distance(first, second);
        if (distance > 0 && distance <= kReach)  // a copy is no second witness
          near_.push_back({x, y, cycles_.chi2(first, second)});
      }
    }
    if (near_.size() >= kLeastPairs) {
      std::vector<double> all;
      for (const Pair& pair : near_) all.push_back(pair.chi2);
      result_.noise_scale = std::max(kLeastScale, median(std::move(all)) / median_chi2(kDimension));
    }
    near_.erase(std::remove_if(near_.begin(), near_.end(),
                               [&](const Pair& pair) { return pair.chi2 > kTolerance * unit(); }),
                near_.end());
    for (const Pair& pair : near_) in_[pair.x] = in_[pair.y] = true;
    supported_ = in_;
  }

  // Every supported loop into one group: that of the first loop that supports it.
  void group() {
    std::vector<std::vector<std::size_t>> partners(loops().size());
    for (const Pair& pair : near_) {
      partners[pair.x].push_back(pair.y);
      partners[pair.y].push_back(pair.x);
    }
    std::vector<bool> taken(loops().size());
    for (std::size_t seed = 0; seed < loops().size(); ++seed) {
      if (taken[seed] || !in_[seed]) continue;
      Group group{.loops = {seed}};
      taken[seed] = true;
      for (const std::size_t partner : partners[seed]) {
        if (taken[partner]) continue;
        taken[partner] = true;
        group.loops.push_back(partner);
      }
      groups_.push_back(std::move(group));
    }
  }

  // Greedily, until no two groups contradict each other: the one that most loops speak against, per
  // loop that speaks for it.
  void drop_contradicting() {
    std::vector<std::vector<std::size_t>> foes(groups_.size());
    std::vector<double> against(groups_.size(), 0.0);
    for (std::size_t x = 0; x < groups_.size(); ++x) {
      const Loop& first = loops()[groups_[x].loops.front()];
      for (std::size_t y = x + 1; y < groups_.size(); ++y) {
        const Loop& second = loops()[groups_[y].loops.front()];
        if (!cycles_.share_chains(first, second)) break;
        if (cycles_.chi2(first, second) <= kTolerance * unit()) continue;
        foes[x].push_back(y);
        foes[y].push_back(x);
        against[x] += static_cast<double>(groups_[y].loops.size());
        against[y] += static_cast<double>(groups_[x].loops.size());
      }
    }
    while (true) {
      std::optional<std::size_t> worst;
      double most = 0.0;
      for (std::size_t x = 0; x < groups_.size(); ++x) {
        const double odds = against[x] / static_cast<double>(groups_[x].loops.size());
        if (!groups_[x].in || odds <= most) continue;
        most = odds;
        worst = x;
      }
      if (!worst) return;
      leave_out(groups_[*worst]);
      for (const std::size_t foe : foes[*worst])
        against[foe] -= static_cast<double>(groups_[*worst].loops.size());
      for (const std::size_t loop : groups_[*worst].loops) {
        supported_[loop] = false;
        contradicted_[loop] = true;
      }
    }
  }

  void leave_out(Group& group) {
    group.in = false;
    for (const std::size_t loop : group.loops) in_[loop] = false;
  }

  // False where there is no solution.
  bool solve_supported() {
    solve(options_.init, std::min(kIterationsWithAll, options_.max_iterations));
    if (interrupted()) return false;
    if (result_.summary.usable() && worst_ratio() <= kFits * scale_) return true;
    leave_out_smaller_half();
    graph_.values() = start_;
    solve(options_.init, options_.max_iterations);
    return revise();
  }

  void leave_out_smaller_half() {
    std::vector<double> sizes;  // by loop
    for (const Group& group : groups_)
      if (group.in)
        sizes.insert(sizes.end(), group.loops.size(), static_cast<double>(group.loops.size()));
    if (sizes.empty()) return;
    const double least = median(std::move(sizes));
    for (Group& group : groups_)
      if (group.in && static_cast<double>(group.loops.size()) < least) leave_out(group);
  }

  // Without what does not fit, the worst first, until all does.
  bool revise() {
    for (int round = 0; round < kMostRounds && result_.summary.usable(); ++round) {
      const double worst = worst_ratio();
      const double most = kTolerance * scale_;
      if (worst <= most) break;
      for (std::size_t i = 0; i < loops().size(); ++i)
        if (in_[i] && ratio(i) > std::max(most, worst / 4.0)) in_[i] = false;
      solve(InitMethod::kFile, options_.max_iterations);
    }
    return result_.summary.usable();
  }

  void take_back(bool supported) {
    for (int round = 0; round < kMostRounds && result_.summary.usable(); ++round) {
      if (!take_back_once(supported)) return;
      solve(InitMethod::kFile, options_.max_iterations);
      if (!revise()) return;
    }
  }

  // What was taken in bit by bit may have led to a minimum beside the best one.
  void start_again() {
    if (!result_.summary.usable()) return;
    const Values found = graph_.values();
    const SolveSummary summary = result_.summary;
    graph_.values() = start_;
    solve(options_.init, options_.max_iterations);
    if (interrupted() ||
        (result_.summary.usable() && result_.summary.final_chi2 <= summary.final_chi2))
      return;
    graph_.values() = found;
    result_.summary = summary;
  }

  // What agrees with the solution as well as its covariance lets it.
  bool take_back_once(bool supported) {
    const double most = kTolerance * scale_ * median_chi2(kDimension);
    std::optional<Result<Marginals>> marginals;
    bool any = false;
    std::vector<bool> now = in_;
    for (std::size_t i = 0; i < loops().size(); ++i) {
      if (in_[i] || (supported && !supported_[i])) continue;
      const Loop& loop = loops()[i];
      UncertainPose<Pose> solved = solved_pose(loop);
      bool agrees = disagreement(solved, loop.T_a_b) <= most;  // more covariance makes it less
      if (!agrees) {
        if (!marginals)
          marginals.emplace(Marginals::compute(graph_.with_factors(kept()), options_));
        if (!*marginals) return false;
        solved.covariance = (*marginals)->relative_covariance(slot(loop.a), slot(loop.b));
        agrees = disagreement(solved, loop.T_a_b) <= most;
      }
      now[i] = agrees;
      any |= agrees;
    }
    in_ = std::move(now);
    return any;
  }

  [[nodiscard]] UncertainPose<Pose> solved_pose(const Loop& loop) const {
    const auto& poses = [&]() -> const auto& {
      if constexpr (std::is_same_v<Pose, Se2>)
        return graph_.values().pose2;
      else
        return graph_.values().pose3;
    }();
    return {poses[loop.a].inverse() * poses[loop.b]};
  }
  [[nodiscard]] VariableSlot slot(std::uint32_t pose) const {
    constexpr bool kPlane = std::is_same_v<Pose, Se2>;
    return graph_.slot_of(kPlane ? VariableType::kPose2 : VariableType::kPose3, pose);
  }

  [[nodiscard]] std::vector<bool> kept() const {
    std::vector<bool> kept(graph_.factor_count(), true);
    for (std::size_t i = 0; i < loops().size(); ++i) kept[loops()[i].factor] = in_[i];
    return kept;
  }
  void solve(InitMethod init, int iterations) {
    Graph rest = graph_.with_factors(kept());
    SolveOptions options = options_;
    options.init = init;
    options.max_iterations = iterations;
    result_.summary = optimize(rest, options);
    graph_.values() = rest.values();
  }
  [[nodiscard]] bool interrupted() const {
    return result_.summary.stop_reason == StopReason::kInterrupted;
  }

  // chi2 at the solution over its median, were the information right.
  [[nodiscard]] double ratio(std::size_t loop) const {
    const auto [batch, index] = graph_.factors()[loops()[loop].factor];
    double chi2 = 0.0;
    graph_.batches()[batch]->evaluate_chi2(
        index, index + 1, {.values = graph_.values(), .chart = options_.chart}, &chi2);
    return chi2 / median_chi2(kDimension);
  }
  // Of the loops in the solution; and the scale they have by it.
  double worst_ratio() {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < loops().size(); ++i)
      if (in_[i]) ratios.push_back(ratio(i));
    if (ratios.empty()) return 0.0;
    const double worst = *std::max_element(ratios.begin(), ratios.end());
    scale_ = std::max(result_.noise_scale, median(std::move(ratios)));
    return worst;
  }

  GatedSolution finish() {
    result_.loops = loops().size();
    for (std::size_t i = 0; i < loops().size() && result_.summary.usable(); ++i) {
      if (in_[i]) continue;
      result_.left_out.push_back(
          {loops()[i].factor, contradicted_[i] ? GateTest::kPairs : GateTest::kResidual,
           ratio(i) * median_chi2(kDimension), kTolerance * scale_ * median_chi2(kDimension)});
    }
    std::sort(result_.left_out.begin(), result_.left_out.end(),
              [](const LeftOutLoop& x, const LeftOutLoop& y) { return x.factor < y.factor; });
    return std::move(result_);
  }

  Graph& graph_;
  const Values start_ = graph_.values();
  SolveOptions options_;
  LoopCycles<Pose> cycles_;
  std::vector<bool> in_;            // by loop: takes part
  std::vector<bool> supported_;     // by loop: others nearby agree, and no more speak against them
  std::vector<bool> contradicted_;  // by loop: others nearby agree, but more speak against them
  std::vector<Pair> near_;
  std::vector<Group> groups_;
  double scale_ = 1.0;  // of residuals at the solution
  GatedSolution result_;
};

template <class Pose>
bool has_loops(const Graph& graph) {
  return !LoopCycles<Pose>(graph).loops().empty();
}

}  // namespace

Result<GatedSolution> solve_gated(Graph& graph, const SolveOptions& options) {
  const bool in_space = has_loops<Se3>(graph);
  if (in_space && has_loops<Se2>(graph))
    return Error{ErrorCode::kUsage,
                 "the graph has loop closures in the plane and in space: gate them apart"};
  return in_space ? LoopGate<Se3>(graph, options).run() : LoopGate<Se2>(graph, options).run();
}

}  // namespace cairn
