// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/replay/thinning.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <type_traits>

#include "cairn/core/disjoint_sets.hpp"
#include "cairn/factors/build_transaction.hpp"
#include "cairn/factors/factor_codec.hpp"
#include "cairn/factors/number_row.hpp"
#include "cairn/solver/loop_cycles.hpp"

namespace cairn {
namespace {

constexpr std::size_t kNewestKept = 50;    // of each frame: the robot is there
constexpr std::size_t kOtherVisit = 20;    // poses of one frame that are so far apart
constexpr std::size_t kMostNeighbors = 6;  // more would fill the map with factors

template <class Pose>
class Thinner {
 public:
  Thinner(const PoseGraph& map, const std::string& source, const ThinningOptions& options)
      : map_(map), options_(options), place_in_frame_(map.nodes.size()), sets_(map.nodes.size()) {
    number_frames();
    find_eligible(source);
    fill_cells();
  }

  void run(Thinning& thinning) {
    for (NodeIndex node = 0; node < map_.nodes.size(); ++node) {
      if (thinning.nodes.size() >= options_.at_most) break;
      if (!eligible_[node] || !is_redundant(node)) continue;
      const std::optional<double> lost = take_out(node);
      if (!lost) continue;
      thinning.nodes.push_back(node);
      thinning.information_lost += *lost;
    }
    write_factors(thinning);
  }

 private:
  static constexpr int d = UncertainPose<Pose>::kDimension;
  static constexpr VariableType kType =
      std::is_same_v<Pose, Se2> ? VariableType::kPose2 : VariableType::kPose3;
  using Covariance = typename UncertainPose<Pose>::Covariance;
  using Cell = std::tuple<std::int64_t, std::int64_t, std::int64_t>;

  struct Edge {
    NodeIndex a, b;
    UncertainPose<Pose> T_a_b;
    bool odometry;
    bool made;  ///< by this thinning
    bool gone = false;
  };
  struct Neighbor {
    NodeIndex node;
    UncertainPose<Pose> T;  ///< from the pose that is taken out
    bool odometry;
  };
  struct Tie {  // between two neighbors
    std::size_t i, j;
    UncertainPose<Pose> T_i_j;
    double log_det;
    bool odometry;
  };

  void number_frames() {
    std::map<OdometryFrame, std::size_t> counts;
    for (NodeIndex i = 0; i < map_.nodes.size(); ++i)
      place_in_frame_[i] = counts[map_.nodes[i].id.frame]++;
    eligible_.resize(map_.nodes.size());
    for (NodeIndex i = map_.frozen_nodes; i < map_.nodes.size(); ++i) {
      const std::size_t place = place_in_frame_[i];
      eligible_[i] = map_.nodes[i].type == kType && place > 0 &&
                     place + kNewestKept < counts[map_.nodes[i].id.frame];
    }
  }

  // Everything that leads to a pose must be a committed relative pose.
  void find_eligible(const std::string& source) {
    std::set<NodeIndex> undone;
    for (std::size_t f = 0; f < map_.factors.size(); ++f) {
      const StoredFactor& factor = map_.factors[f];
      if (!is_enabled(factor.state)) {
        if (factor.name.transaction.source == source)
          undone.insert(factor.nodes.begin(), factor.nodes.end());
        continue;
      }
      std::optional<Edge> edge = edge_of(factor);
      if (!edge) {
        for (const NodeIndex node : factor.nodes) eligible_[node] = false;
        continue;
      }
      sets_.join(edge->a, edge->b);
      add(std::move(*edge));
    }
    for (const NodeIndex node : undone)
      for (const std::size_t e : edges_of_[node]) eligible_[other(edges_[e], node)] = false;
  }

  std::optional<Edge> edge_of(const StoredFactor& factor) const {
    constexpr std::size_t kMeasured = value_numbers(kType);
    const FactorTypeInfo& info = *find_factor_type(factor.type);
    const bool relative = info.signature == std::vector{kType, kType} &&
                          info.numbers == kMeasured + d * (d + 1) / 2 &&
                          factor.kind != FactorKind::kOther;
    if (!relative || factor.state != FactorState::kCommitted) return std::nullopt;
    Edge edge{factor.nodes[0], factor.nodes[1], {}, factor.kind == FactorKind::kOdometry, false};
    NumberReader{factor.numbers.data()}(edge.T_a_b.T);
    Covariance information;
    const double* next = factor.numbers.data() + kMeasured;
    for (int row = 0; row < d; ++row)
      for (int column = row; column < d; ++column)
        information(row, column) = information(column, row) = *next++;
    const Eigen::LLT<Covariance> llt(information);
    if (llt.info() != Eigen::Success || llt.rcond() < 1e-12) return std::nullopt;
    edge.T_a_b.covariance = llt.solve(Covariance::Identity());
    return edge;
  }

  void add(Edge edge) {
    edges_of_[edge.a].push_back(edges_.size());
    edges_of_[edge.b].push_back(edges_.size());
    edges_.push_back(std::move(edge));
  }
  static NodeIndex other(const Edge& edge, NodeIndex node) {
    return edge.a == node ? edge.b : edge.a;
  }

  [[nodiscard]] Pose pose(NodeIndex node) const {
    Pose T;
    NumberReader{map_.estimates[node].data()}(T);
    return T;
  }
  [[nodiscard]] Cell cell_of(NodeIndex node) const {
    const auto at = [&](double x) {
      return static_cast<std::int64_t>(std::floor(std::clamp(x / options_.radius_m, -1e15, 1e15)));
    };
    const Estimate& e = map_.estimates[node];
    return {at(e[0]), at(e[1]), kType == VariableType::kPose3 ? at(e[2]) : 0};
  }
  void fill_cells() {
    for (NodeIndex i = 0; i < map_.nodes.size(); ++i)
      if (map_.nodes[i].type == kType && !edges_of_[i].empty()) cells_[cell_of(i)].push_back(i);
  }

  [[nodiscard]] bool is_redundant(NodeIndex node) {
    const auto [x, y, z] = cell_of(node);
    std::size_t newer = 0;
    for (std::int64_t dx = -1; dx <= 1; ++dx)
      for (std::int64_t dy = -1; dy <= 1; ++dy)
        for (std::int64_t dz = -1; dz <= 1; ++dz) {
          const auto cell = cells_.find({x + dx, y + dy, z + dz});
          if (cell == cells_.end()) continue;
          for (const NodeIndex near : cell->second)
            if (near > node && sees_the_same(node, near) && ++newer >= options_.visits) return true;
        }
    return false;
  }
  [[nodiscard]] bool sees_the_same(NodeIndex node, NodeIndex near) {
    const bool same_frame = map_.nodes[node].id.frame == map_.nodes[near].id.frame;
    if (same_frame && place_in_frame_[near] < place_in_frame_[node] + kOtherVisit) return false;
    if (sets_.root(node) != sets_.root(near)) return false;
    const typename Pose::Tangent apart = (pose(node).inverse() * pose(near)).log();
    constexpr int kTurns = d == 3 ? 1 : 3;
    return apart.template head<d - kTurns>().norm() <= options_.radius_m &&
           apart.template tail<kTurns>().norm() <= options_.angle_rad;
  }

  // What was lost; nothing where it stays.
  std::optional<double> take_out(NodeIndex node) {
    const std::vector<Neighbor> neighbors = neighbors_of(node);
    if (neighbors.size() < 2 || neighbors.size() > kMostNeighbors) return std::nullopt;
    const std::vector<Tie> tree = best_tree(neighbors);
    const double lost = information_lost(neighbors, tree);
    if (!std::isfinite(lost)) return std::nullopt;
    for (const std::size_t e : edges_of_[node]) {
      edges_[e].gone = true;
      std::erase(edges_of_[other(edges_[e], node)], e);
    }
    edges_of_.erase(node);
    std::erase(cells_[cell_of(node)], node);
    for (const Tie& tie : tree)
      add({neighbors[tie.i].node, neighbors[tie.j].node, tie.T_i_j, tie.odometry, true});
    return lost;
  }

  // Ascending; several measurements of one are combined.
  std::vector<Neighbor> neighbors_of(NodeIndex node) {
    std::map<NodeIndex, Neighbor> found;
    for (const std::size_t e : edges_of_[node]) {
      const Edge& edge = edges_[e];
      const UncertainPose<Pose> T = edge.a == node ? edge.T_a_b : edge.T_a_b.inverse();
      const NodeIndex to = other(edge, node);
      const auto [at, is_new] = found.try_emplace(to, Neighbor{to, T, edge.odometry});
      if (is_new) continue;
      at->second.T = combine(at->second.T, T);
      at->second.odometry |= edge.odometry;
    }
    std::vector<Neighbor> neighbors;
    for (auto& [to, neighbor] : found) neighbors.push_back(std::move(neighbor));
    return neighbors;
  }
  static UncertainPose<Pose> combine(const UncertainPose<Pose>& x, const UncertainPose<Pose>& y) {
    const Covariance of_y = y.covariance.llt().solve(Covariance::Identity());
    const Covariance both = x.covariance.llt().solve(Covariance::Identity()) + of_y;
    const Eigen::LLT<Covariance> llt(both);
    const typename Pose::Tangent step = llt.solve(of_y * (x.T.inverse() * y.T).log());
    return {x.T.retract(step), llt.solve(Covariance::Identity())};
  }

  static double log_det(const Eigen::MatrixXd& covariance) {
    const Eigen::LLT<Eigen::MatrixXd> llt(covariance);
    if (llt.info() != Eigen::Success) return std::nan("");
    return 2.0 * llt.matrixLLT().diagonal().array().log().sum();
  }

  // Odometry stays a chain; then the ties that know most.
  static std::vector<Tie> best_tree(const std::vector<Neighbor>& neighbors) {
    std::vector<Tie> ties;
    for (std::size_t i = 0; i < neighbors.size(); ++i)
      for (std::size_t j = i + 1; j < neighbors.size(); ++j) {
        Tie tie{i, j, neighbors[i].T.inverse() * neighbors[j].T, 0.0,
                neighbors[i].odometry && neighbors[j].odometry};
        tie.log_det = log_det(tie.T_i_j.covariance);
        ties.push_back(std::move(tie));
      }
    std::sort(ties.begin(), ties.end(), [](const Tie& x, const Tie& y) {
      return std::tuple(!x.odometry, x.log_det, x.i, x.j) <
             std::tuple(!y.odometry, y.log_det, y.i, y.j);
    });
    DisjointSets joined(neighbors.size());
    std::vector<Tie> tree;
    for (Tie& tie : ties) {
      if (joined.root(tie.i) == joined.root(tie.j)) continue;
      joined.join(tie.i, tie.j);
      tree.push_back(std::move(tie));
    }
    return tree;
  }

  // The ties share the errors of what led to the pose: their joint covariance against that of ties
  // that were independent.
  static double information_lost(const std::vector<Neighbor>& neighbors,
                                 const std::vector<Tie>& tree) {
    const auto size = static_cast<Eigen::Index>(neighbors.size());
    Eigen::MatrixXd errors = Eigen::MatrixXd::Zero(size * d, size * d);
    for (Eigen::Index k = 0; k < size; ++k)
      errors.block<d, d>(k * d, k * d) = neighbors[static_cast<std::size_t>(k)].T.covariance;
    Eigen::MatrixXd ties = Eigen::MatrixXd::Zero((size - 1) * d, size * d);
    double independent = 0.0;
    for (Eigen::Index t = 0; t < size - 1; ++t) {
      const Tie& tie = tree[static_cast<std::size_t>(t)];
      ties.block<d, d>(t * d, static_cast<Eigen::Index>(tie.j) * d).setIdentity();
      ties.block<d, d>(t * d, static_cast<Eigen::Index>(tie.i) * d) =
          -tie.T_i_j.T.inverse().adjoint();
      independent += tie.log_det;
    }
    return std::max(0.0, 0.5 * (independent - log_det(ties * errors * ties.transpose())));
  }

  void write_factors(Thinning& thinning) const {
    Transaction transaction;
    for (const Edge& edge : edges_) {
      if (!edge.made || edge.gone) continue;
      const Covariance information = edge.T_a_b.covariance.llt().solve(Covariance::Identity());
      add_between(transaction, map_.nodes[edge.a].id, map_.nodes[edge.b].id, edge.T_a_b.T,
                  0.5 * (information + information.transpose()),
                  edge.odometry ? FactorKind::kOdometry : FactorKind::kLoop);
    }
    for (NewFactor& factor : transaction.factors) thinning.factors.push_back(std::move(factor));
  }

  const PoseGraph& map_;
  const ThinningOptions& options_;
  std::vector<std::size_t> place_in_frame_;  ///< by node
  std::vector<bool> eligible_;               ///< by node
  DisjointSets sets_;
  std::vector<Edge> edges_;
  std::map<NodeIndex, std::vector<std::size_t>> edges_of_;
  std::map<Cell, std::vector<NodeIndex>> cells_;
};

}  // namespace

Thinning plan_thinning(const PoseGraph& map, const std::string& source,
                       const ThinningOptions& options) {
  Thinning thinning;
  Thinner<Se2>(map, source, options).run(thinning);
  Thinner<Se3>(map, source, options).run(thinning);
  std::sort(thinning.nodes.begin(), thinning.nodes.end());
  return thinning;
}

}  // namespace cairn
