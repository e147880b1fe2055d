// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/initialize.hpp"

#include <cmath>
#include <limits>

#include "cairn/core/stopwatch.hpp"
#include "cairn/solver/chordal.hpp"
#include "cairn/solver/chordal_landmarks.hpp"
#include "cairn/solver/relative_pose_graph.hpp"

namespace cairn {
namespace {

class Initializer {
 public:
  Initializer(const Problem& problem, const Elimination& elimination, const SolveOptions& options,
              Values& values)
      : problem_(problem),
        elimination_(elimination),
        options_(options),
        values_(values),
        poses2_(problem),
        poses3_(problem) {}

  void run(SolveSummary& summary) {
    if (options_.init != InitMethod::kAuto) {
      Values start = values_;
      if (try_method(options_.init, start, summary)) values_ = std::move(start);
      return;
    }
    const double explained = 0.5 * static_cast<double>(summary.degrees_of_freedom);
    Values start = values_;
    Values best = values_;
    double best_cost = std::numeric_limits<double>::infinity();
    for (const InitMethod method :
         {InitMethod::kFile, InitMethod::kOdometry, InitMethod::kTree, InitMethod::kChordal}) {
      if (best_cost <= explained) break;
      start = values_;
      const std::optional<double> cost = try_method(method, start, summary);
      if (!cost || !(*cost < best_cost)) continue;
      best_cost = *cost;
      std::swap(best, start);
      summary.init_chosen = method;
    }
    values_ = std::move(best);
  }

 private:
  // The cost of the start; nothing where the method does not lead to one.
  std::optional<double> try_method(InitMethod method, Values& start, SolveSummary& summary) const {
    const Stopwatch watch;
    if (!move_poses(method, start)) return std::nullopt;
    if (method == InitMethod::kOdometry || method == InitMethod::kTree) predict_landmarks(start);
    const RangeCost cost = evaluate(start);
    summary.init_candidates.push_back({method, cost.chi2, watch.seconds()});
    summary.init_chosen = method;
    return cost.cost;
  }

  bool move_poses(InitMethod method, Values& start) const {
    switch (method) {
      case InitMethod::kOdometry:
      case InitMethod::kTree:
        chain_poses(poses2_, method == InitMethod::kOdometry, start.pose2);
        chain_poses(poses3_, method == InitMethod::kOdometry, start.pose3);
        return true;
      case InitMethod::kChordal:
        return move_chordally(poses2_, start.pose2, start.point2.empty(), start) &&
               move_chordally(poses3_, start.pose3, start.point3.empty(), start);
      case InitMethod::kAuto:
      case InitMethod::kFile:
        break;
    }
    return true;
  }

  template <class Pose>
  bool move_chordally(const RelativePoseGraph<Pose>& graph, std::vector<Pose>& poses,
                      bool poses_only, Values& start) const {
    return poses_only ? chordal_poses(graph, elimination_, options_.kernel, poses)
                      : chordal_poses_and_landmarks(problem_, graph, options_.kernel, start);
  }

  // Each landmark from the first factor that tells where it is.
  void predict_landmarks(Values& start) const {
    std::vector<bool> placed = problem_.held;
    for (const FactorBatch* batch : problem_.batches) {
      const auto signature = batch->signature();
      if (signature.size() < 2 || is_pose(signature.back())) continue;
      for (std::size_t i = 0; i < batch->size(); ++i) {
        const std::uint32_t index = batch->variable_indices()[(i + 1) * signature.size() - 1];
        const VariableSlot slot = problem_.graph->slot_of(signature.back(), index);
        if (!placed[slot] && batch->predict_last(i, start)) placed[slot] = true;
      }
    }
  }

  [[nodiscard]] RangeCost evaluate(const Values& start) const {
    const EvaluationContext context{start, options_.chart, options_.loss,
                                    options_.loss_on_loops_only};
    RangeCost sum;
    for (const FactorBatch* batch : problem_.batches) {
      const RangeCost cost = batch->evaluate_cost(0, batch->size(), context);
      sum.chi2 += cost.chi2;
      sum.cost += cost.cost;
    }
    return sum;
  }

  const Problem& problem_;
  const Elimination& elimination_;
  const SolveOptions& options_;
  Values& values_;
  RelativePoseGraph<Se2> poses2_;
  RelativePoseGraph<Se3> poses3_;
};

}  // namespace

void initialize(const Problem& problem, const Elimination& elimination, const SolveOptions& options,
                Values& values, SolveSummary& summary) {
  if (options.init == InitMethod::kFile) return;
  Initializer(problem, elimination, options, values).run(summary);
}

}  // namespace cairn
