// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/false_loops.hpp"

#include <algorithm>
#include <optional>
#include <type_traits>
#include <vector>

#include "cairn/factors/between.hpp"
#include "datasets/random.hpp"

namespace cairn {
namespace {

constexpr std::size_t kLeastApart = 40;  // keyframes
constexpr std::size_t kInARow = 4;
constexpr std::size_t kMostDraws = 1000;  // for each

template <class F>
class Drawing {
 public:
  using Pose = decltype(F::T_a_b_measured);

  Drawing(const Graph& graph, const Graph& solved, const FalseLoopOptions& options)
      : options_(options), random_(options.seed) {
    for (const Variable& variable : solved.variables()) {
      if (variable.type != F::Variables::kArray[0]) continue;
      if constexpr (std::is_same_v<Pose, Se2>)
        path_.push_back({variable.id, solved.values().pose2[variable.index], {}});
      else
        path_.push_back({variable.id, solved.values().pose3[variable.index], {}});
    }
    std::sort(path_.begin(), path_.end(),
              [](const Keyframe& x, const Keyframe& y) { return x.id.value < y.id.value; });
    const TypedBatch<F>* batch = graph.find_batch<F>();
    for (const FactorRef factor : graph.factors()) {
      if (batch == nullptr || graph.batches()[factor.batch].get() != batch) continue;
      if (batch->kinds()[factor.index] == FactorKind::kLoop)
        true_loops_.push_back(batch->factor(factor.index));
      else
        add_odometry(graph, factor, batch->factor(factor.index).T_a_b_measured);
    }
  }

  std::set<std::size_t> run(Graph& graph) {
    std::set<std::size_t> places;
    if (true_loops_.empty() || path_.empty()) return places;
    const std::size_t alone = options_.count - std::min(options_.count, options_.in_groups);
    for (std::size_t draw = 0; draw < kMostDraws * options_.count && places.size() < options_.count;
         ++draw) {
      F loop = true_loops_[random_.index(true_loops_.size())];
      std::size_t a = random_.index(path_.size()), b = random_.index(path_.size());
      const std::size_t in_a_row =
          places.size() < alone ? 1 : std::min(kInARow, options_.count - places.size());
      for (std::size_t i = 0; i < in_a_row && is_false(loop, a, b); ++i, ++a, ++b) {
        const std::size_t place = graph.factor_count();
        if (!graph.add_factor(loop, {path_[a].id, path_[b].id}, FactorKind::kLoop)) break;
        places.insert(place);
        if (!path_[a].T_next || !path_[b].T_next) break;
        loop.T_a_b_measured = path_[a].T_next->inverse() * loop.T_a_b_measured * *path_[b].T_next;
      }
    }
    return places;
  }

 private:
  struct Keyframe {
    VariableId id;
    Pose T_map_body;
    std::optional<Pose> T_next;  ///< by odometry
  };

  void add_odometry(const Graph& graph, FactorRef factor, const Pose& T_a_b) {
    const std::vector<VariableSlot> slots = graph.slots_of(factor);
    const VariableId from = graph.variables()[slots[0]].id, to = graph.variables()[slots[1]].id;
    const auto keyframe =
        std::lower_bound(path_.begin(), path_.end(), from,
                         [](const Keyframe& k, VariableId id) { return k.id.value < id.value; });
    if (keyframe != path_.end() && keyframe + 1 != path_.end() && (keyframe + 1)->id == to)
      keyframe->T_next = T_a_b;
  }

  [[nodiscard]] bool is_false(const F& loop, std::size_t a, std::size_t b) const {
    if (b >= path_.size()) return false;
    const auto robot = [](const Keyframe& k) { return k.id.value >> 56; };
    if (options_.between_robots ? a >= b || robot(path_[a]) == robot(path_[b])
                                : a + kLeastApart >= b || robot(path_[a]) != robot(path_[b]))
      return false;
    const Pose T_map_b = path_[a].T_map_body * loop.T_a_b_measured;
    return (T_map_b.translation() - path_[b].T_map_body.translation()).norm() >=
           options_.least_off_m;
  }

  FalseLoopOptions options_;
  Random random_;
  std::vector<Keyframe> path_;  // ascending by id
  std::vector<F> true_loops_;
};

}  // namespace

template <class F>
std::set<std::size_t> add_false_loops(Graph& graph, const Graph& solved,
                                      const FalseLoopOptions& options) {
  return Drawing<F>(graph, solved, options).run(graph);
}

template std::set<std::size_t> add_false_loops<BetweenSe2>(Graph&, const Graph&,
                                                           const FalseLoopOptions&);
template std::set<std::size_t> add_false_loops<BetweenSe3>(Graph&, const Graph&,
                                                           const FalseLoopOptions&);

}  // namespace cairn
