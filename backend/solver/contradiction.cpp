// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/contradiction.hpp"

#include <algorithm>

#include "cairn/solver/loop_cycles.hpp"
#include "cairn/solver/loop_groups.hpp"

namespace cairn {
namespace {

constexpr int kMostEdges = 10'000;  // of a chain

template <class Pose>
class ChainSearch {
 public:
  using Loop = typename LoopCycles<Pose>::Loop;

  ChainSearch(const Graph& graph, std::size_t edge) : edges_(all_edges(graph)) {
    for (const Loop& loop : edges_) {
      if (loop.factor == edge) edge_ = loop;
      const std::size_t poses = std::max(loop.a, loop.b) + std::size_t{1};
      if (best_.size() < poses) best_.resize(poses);
    }
  }

  std::optional<Contradiction> run(double threshold, const std::function<bool()>& keep_going) {
    if (!edge_) return std::nullopt;
    best_[edge_->a] = Chain{};
    std::vector<std::uint32_t> reached{edge_->a};
    index_edges();
    for (int count = 1; count <= kMostEdges && !reached.empty(); ++count) {
      if (keep_going && !keep_going()) return std::nullopt;
      reached = extend(reached);
      if (!std::binary_search(reached.begin(), reached.end(), edge_->b)) continue;
      const double chi2 = disagreement(best_[edge_->b]->T, edge_->T_a_b);
      if (chi2 > threshold) return Contradiction{chain_to(edge_->b), chi2, threshold};
    }
    return std::nullopt;
  }

 private:
  struct Chain {
    UncertainPose<Pose> T;  // from the edge's first end
    std::size_t step = 0;   // place of the last one in steps_; 0: none
  };
  struct Step {
    std::size_t edge = 0, before = 0;
  };

  // As if every one of them were a loop, which they are told by.
  static std::vector<Loop> all_edges(Graph graph) {
    for (const FactorRef factor : std::vector(graph.factors().begin(), graph.factors().end()))
      graph.set_kind(factor, FactorKind::kLoop);
    return LoopCycles<Pose>(graph).loops();
  }

  void index_edges() {
    edges_at_.resize(best_.size());
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      if (edges_[i].factor == edge_->factor) continue;
      edges_at_[edges_[i].a].push_back(i);
      edges_at_[edges_[i].b].push_back(i);
    }
  }

  // By one more edge; the poses whose best chain that is now.
  std::vector<std::uint32_t> extend(const std::vector<std::uint32_t>& from) {
    std::vector<std::pair<std::uint32_t, Chain>> longer;
    for (const std::uint32_t pose : from) {
      for (const std::size_t i : edges_at_[pose]) {
        const Loop& edge = edges_[i];
        const bool forward = edge.a == pose;
        const std::uint32_t other = forward ? edge.b : edge.a;
        Chain chain{best_[pose]->T * (forward ? edge.T_a_b : edge.T_a_b.inverse()), 0};
        if (best_[other] && size(*best_[other]) <= size(chain)) continue;
        steps_.push_back({i, best_[pose]->step});
        chain.step = steps_.size();
        longer.emplace_back(other, std::move(chain));
      }
    }
    std::vector<std::uint32_t> changed;
    for (auto& [pose, chain] : longer) {
      if (best_[pose] && size(*best_[pose]) <= size(chain)) continue;
      best_[pose] = std::move(chain);
      changed.push_back(pose);
    }
    std::sort(changed.begin(), changed.end());
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    return changed;
  }
  static double size(const Chain& chain) { return chain.T.covariance.trace(); }

  [[nodiscard]] std::vector<std::size_t> chain_to(std::uint32_t pose) const {
    std::vector<std::size_t> factors;
    for (std::size_t step = best_[pose]->step; step > 0; step = steps_[step - 1].before)
      factors.push_back(edges_[steps_[step - 1].edge].factor);
    std::reverse(factors.begin(), factors.end());
    return factors;
  }

  std::vector<Loop> edges_;
  std::optional<Loop> edge_;
  std::vector<std::vector<std::size_t>> edges_at_;  // by pose
  std::vector<std::optional<Chain>> best_;          // by pose
  std::vector<Step> steps_;
};

template <class Pose>
std::optional<Contradiction> find_in(const Graph& graph, std::size_t edge,
                                     const std::function<bool()>& keep_going) {
  const std::optional<LoopGroups> groups = find_groups(LoopCycles<Pose>(graph), keep_going);
  if (!groups) return std::nullopt;
  const double threshold = largest_chi2(UncertainPose<Pose>::kDimension) * groups->noise_scale;
  return ChainSearch<Pose>(graph, edge).run(threshold, keep_going);
}

}  // namespace

std::optional<Contradiction> find_contradiction(const Graph& graph, std::size_t edge,
                                                const std::function<bool()>& keep_going) {
  const FactorBatch& batch = *graph.batches()[graph.factors()[edge].batch];
  if (!batch.relative_poses2().empty()) return find_in<Se2>(graph, edge, keep_going);
  if (!batch.relative_poses3().empty()) return find_in<Se3>(graph, edge, keep_going);
  return std::nullopt;
}

}  // namespace cairn
