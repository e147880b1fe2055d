// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/chordal_landmarks.hpp"

#include <type_traits>

#include "cairn/core/disjoint_sets.hpp"
#include "cairn/linear/linear_solver.hpp"

namespace cairn {
namespace {

// No block here has more than four rows or columns: kept off the heap.
using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 4, 4>;

// sum over terms of w |A_a x_a + A_b x_b - c|^2 over nodes of mixed size, several right-hand sides
// at once.
class LeastSquares {
 public:
  struct Term {
    int a, b;
    Small A_a, A_b, c;
    double weight;
  };

  int add_node(int dimension) {
    dimensions_.push_back(dimension);
    known_.emplace_back();
    return static_cast<int>(dimensions_.size()) - 1;
  }
  void hold(int node, const Small& value) { known_[node] = value; }
  void add(Term term) { terms_.push_back(std::move(term)); }

  // One matrix per node (dimension x right-hand sides); empty when singular.
  std::vector<Small> solve(int right_hand_sides, Kernel kernel) {
    number_unknowns();
    const Elimination elimination = find_elimination(graph_);
    const BlockPattern pattern =
        BlockPattern::build(graph_, elimination.position, unknown_dimensions_);
    std::vector<double> values(pattern.value_count(), 0.0);
    Eigen::MatrixXd rhs = Eigen::MatrixXd::Zero(pattern.scalar_size(), right_hand_sides);
    for (const Term& term : terms_) accumulate(term, elimination, pattern, values, rhs);
    const std::unique_ptr<LinearSolver> linear = make_multifrontal_solver(kernel);
    linear->analyze(pattern, elimination);
    if (!linear->factorize(values.data())) return {};
    for (int k = 0; k < right_hand_sides; ++k) linear->solve(rhs.col(k).data(), rhs.col(k).data());
    if (!rhs.allFinite()) return {};
    std::vector<Small> solution = known_;
    for (std::size_t node = 0; node < known_.size(); ++node) {
      if (unknown_[node] < 0) continue;
      const int first = pattern.scalar_begin[elimination.position[unknown_[node]]];
      solution[node] = rhs.middleRows(first, dimensions_[node]);
    }
    return solution;
  }

 private:
  void number_unknowns() {
    unknown_.assign(dimensions_.size(), -1);
    for (std::size_t node = 0; node < dimensions_.size(); ++node) {
      if (known_[node].size() > 0) continue;
      unknown_[node] = static_cast<int>(unknown_dimensions_.size());
      unknown_dimensions_.push_back(dimensions_[node]);
    }
    std::vector<std::pair<int, int>> pairs;
    for (const Term& term : terms_) {
      if (unknown_[term.a] >= 0 && unknown_[term.b] >= 0)
        pairs.emplace_back(unknown_[term.a], unknown_[term.b]);
    }
    graph_ = BlockGraph::from_pairs(static_cast<int>(unknown_dimensions_.size()), pairs);
  }

  void accumulate(const Term& term, const Elimination& elimination, const BlockPattern& pattern,
                  std::vector<double>& values, Eigen::MatrixXd& rhs) const {
    const auto add_block = [&](int row, int column, const Small& block) {
      const int entry = pattern.find(row, column);
      Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>(
          values.data() + pattern.value_begin[column] +
              static_cast<std::size_t>(pattern.row_offset[entry]),
          block.rows(), block.cols(), Eigen::OuterStride<>(pattern.height[column])) += block;
    };
    const int a = unknown_[term.a] < 0 ? -1 : elimination.position[unknown_[term.a]];
    const int b = unknown_[term.b] < 0 ? -1 : elimination.position[unknown_[term.b]];
    Small c = term.c;
    if (a < 0) c -= term.A_a * known_[term.a];
    if (b < 0) c -= term.A_b * known_[term.b];
    const Small WA_a = term.weight * term.A_a, WA_b = term.weight * term.A_b;
    if (a >= 0) {
      add_block(a, a, WA_a.transpose() * term.A_a);
      rhs.middleRows(pattern.scalar_begin[a], pattern.dimension[a]) += WA_a.transpose() * c;
    }
    if (b >= 0) {
      add_block(b, b, WA_b.transpose() * term.A_b);
      rhs.middleRows(pattern.scalar_begin[b], pattern.dimension[b]) += WA_b.transpose() * c;
    }
    if (a < 0 || b < 0) return;
    if (a > b)
      add_block(a, b, WA_a.transpose() * term.A_b);
    else
      add_block(b, a, WA_b.transpose() * term.A_a);
  }

  std::vector<int> dimensions_, unknown_, unknown_dimensions_;
  std::vector<Small> known_;
  std::vector<Term> terms_;
  BlockGraph graph_;
};

// A point seen from a pose: p_body, weighted isotropically.
template <int n>
struct Sighting {
  std::uint32_t pose, point;
  Eigen::Matrix<double, n, 1> p_body;
  double weight;  // 1/m^2
};

template <int n>
auto& points_of(Values& values) {
  if constexpr (n == 2)
    return values.point2;
  else
    return values.point3;
}
template <int n>
auto& poses_of(Values& values) {
  if constexpr (n == 2)
    return values.pose2;
  else
    return values.pose3;
}

// A factor that tells where its point is from a pose tells where it is in the body from a pose at
// the origin.
template <int n>
std::vector<Sighting<n>> find_sightings(const Problem& problem) {
  constexpr VariableType kPose = n == 2 ? VariableType::kPose2 : VariableType::kPose3;
  constexpr VariableType kPoint = n == 2 ? VariableType::kPoint2 : VariableType::kPoint3;
  Values at_origin = problem.graph->values();
  for (auto& pose : poses_of<n>(at_origin)) pose = {};
  std::vector<Sighting<n>> sightings;
  for (const FactorBatch* batch : problem.batches) {
    const auto signature = batch->signature();
    if (signature.size() != 2 || signature[0] != kPose || signature[1] != kPoint) continue;
    for (std::size_t i = 0; i < batch->size(); ++i) {
      const std::uint32_t pose = batch->variable_indices()[2 * i],
                          point = batch->variable_indices()[2 * i + 1];
      if (!batch->predict_last(i, at_origin)) continue;
      const Eigen::MatrixXd J = batch->evaluate(i, {at_origin}).jacobians[1];
      const double weight = J.squaredNorm() / n;
      if (weight > 0.0 && std::isfinite(weight)) {
        sightings.push_back({pose, point, points_of<n>(at_origin)[point], weight});
      }
    }
  }
  return sightings;
}

// Row k of every rotation and coordinate k of every position obey the same equations, so they share
// one matrix: node = (row of R, coordinate of t) for a pose, coordinate for a point; n right-hand
// sides.
template <class Pose>
class JointRelaxation {
 public:
  static constexpr int n = std::is_same_v<Pose, Se2> ? 2 : 3;
  using Rotation = std::remove_cvref_t<decltype(Pose().rotation())>;

  JointRelaxation(const Problem& problem, const RelativePoseGraph<Pose>& graph, Kernel kernel,
                  Values& values)
      : problem_(problem),
        graph_(graph),
        kernel_(kernel),
        values_(values),
        sightings_(find_sightings<n>(problem)) {
    hold_roots();
  }

  bool run() {
    const std::vector<Small> joint = solve_joint();
    if (joint.empty()) return false;
    std::vector<Pose> rotated = poses_of<n>(values_);
    for (std::size_t i = 0; i < rotated.size(); ++i) {
      if (!graph_.held[i])
        rotated[i] = Pose(project(joint[i].topRows(n).transpose()), rotated[i].translation());
    }
    const std::vector<Small> positions = solve_positions(rotated);
    if (positions.empty()) return false;
    for (std::size_t i = 0; i < rotated.size(); ++i) {
      if (!graph_.held[i])
        rotated[i] = Pose(rotated[i].rotation(), positions[i].row(0).transpose());
    }
    poses_of<n>(values_) = std::move(rotated);
    auto& points = points_of<n>(values_);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (point_node_[i] >= 0 && !held_point(i))
        points[i] = positions[point_node_[i]].row(0).transpose();
    }
    return true;
  }

 private:
  static Rotation project(const Eigen::MatrixXd& m) {
    if constexpr (n == 2)
      return So2(std::atan2(m(1, 0) - m(0, 1), m(0, 0) + m(1, 1)));
    else
      return So3::project(m);
  }

  [[nodiscard]] bool held_point(std::size_t index) const {
    constexpr VariableType kPoint = n == 2 ? VariableType::kPoint2 : VariableType::kPoint3;
    return problem_.held[problem_.graph->slot_of(kPoint, static_cast<std::uint32_t>(index))];
  }

  // Absolute factors are not relaxed. A component in which they are all that ties it to the map
  // keeps its pose with the smallest id.
  void hold_roots() {
    const std::size_t poses = graph_.held.size(), points = points_of<n>(values_).size();
    DisjointSets sets(poses + points);
    for (const auto& edge : graph_.edges) sets.join(edge.measured.a, edge.measured.b);
    for (const Sighting<n>& sighting : sightings_) sets.join(sighting.pose, poses + sighting.point);
    std::vector<bool> tied(poses + points, false);
    for (std::size_t i = 0; i < poses; ++i) {
      if (graph_.held[i]) tied[sets.root(i)] = true;
    }
    for (std::size_t i = 0; i < points; ++i) {
      if (held_point(i)) tied[sets.root(poses + i)] = true;
    }
    for (const std::uint32_t pose : graph_.poses_by_id) {
      if (tied[sets.root(pose)]) continue;
      tied[sets.root(pose)] = true;
      graph_.held[pose] = true;
    }
  }

  // Pose nodes first, then one node per point that was sighted.
  void add_nodes(LeastSquares& system, int pose_dimension) {
    for (std::size_t i = 0; i < graph_.held.size(); ++i) system.add_node(pose_dimension);
    const auto& points = points_of<n>(values_);
    point_node_.assign(points.size(), -1);
    for (const Sighting<n>& sighting : sightings_) {
      if (point_node_[sighting.point] >= 0) continue;
      point_node_[sighting.point] = system.add_node(1);
      if (held_point(sighting.point))
        system.hold(point_node_[sighting.point], points[sighting.point].transpose());
    }
  }

  std::vector<Small> solve_joint() {
    LeastSquares system;
    add_nodes(system, n + 1);
    const auto& poses = poses_of<n>(values_);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (!graph_.held[i]) continue;
      Small value(n + 1, n);
      value << poses[i].rotation().matrix().transpose(), poses[i].translation().transpose();
      system.hold(static_cast<int>(i), value);
    }
    for (const auto& edge : graph_.edges) {
      const auto& measured = edge.measured;
      const int a = static_cast<int>(measured.a), b = static_cast<int>(measured.b);
      Small rotation_a = Small::Zero(n, n + 1), rotation_b = Small::Zero(n, n + 1);
      rotation_a.leftCols(n) = -measured.T_a_b.rotation().matrix().transpose();
      rotation_b.leftCols(n).setIdentity();
      system.add({a, b, rotation_a, rotation_b, Small::Zero(n, n), measured.rotation_weight});
      Small position_b = Small::Zero(1, n + 1);
      position_b(0, n) = 1.0;
      system.add({a, b, minus_seen_from(measured.T_a_b.translation()), position_b,
                  Small::Zero(1, n), measured.translation_weight});
    }
    for (const Sighting<n>& sighting : sightings_) {
      system.add({static_cast<int>(sighting.pose), point_node_[sighting.point],
                  minus_seen_from(sighting.p_body), Small::Ones(1, 1), Small::Zero(1, n),
                  sighting.weight});
    }
    return system.solve(n, kernel_);
  }

  // The row that maps (row of R, coordinate of t) to minus the coordinate of R p + t.
  static Small minus_seen_from(const Eigen::Matrix<double, n, 1>& p) {
    Small row(1, n + 1);
    row << -p.transpose(), -1.0;
    return row;
  }

  std::vector<Small> solve_positions(const std::vector<Pose>& rotated) {
    LeastSquares system;
    add_nodes(system, 1);
    for (std::size_t i = 0; i < rotated.size(); ++i) {
      if (graph_.held[i]) system.hold(static_cast<int>(i), rotated[i].translation().transpose());
    }
    const Small one = Small::Ones(1, 1), minus_one = -one;
    const auto add = [&](std::uint32_t a, int b, const Eigen::Matrix<double, n, 1>& p_a,
                         double weight) {
      const Eigen::Matrix<double, n, 1> step = rotated[a].rotation() * p_a;
      system.add({static_cast<int>(a), b, minus_one, one, step.transpose(), weight});
    };
    for (const auto& edge : graph_.edges) {
      add(edge.measured.a, static_cast<int>(edge.measured.b), edge.measured.T_a_b.translation(),
          edge.measured.translation_weight);
    }
    for (const Sighting<n>& s : sightings_) add(s.pose, point_node_[s.point], s.p_body, s.weight);
    return system.solve(n, kernel_);
  }

  const Problem& problem_;
  RelativePoseGraph<Pose> graph_;
  Kernel kernel_;
  Values& values_;
  std::vector<Sighting<n>> sightings_;
  std::vector<int> point_node_;
};

}  // namespace

template <class Pose>
bool chordal_poses_and_landmarks(const Problem& problem, const RelativePoseGraph<Pose>& graph,
                                 Kernel kernel, Values& values) {
  return JointRelaxation<Pose>(problem, graph, kernel, values).run();
}

template bool chordal_poses_and_landmarks(const Problem&, const RelativePoseGraph<Se2>&, Kernel,
                                          Values&);
template bool chordal_poses_and_landmarks(const Problem&, const RelativePoseGraph<Se3>&, Kernel,
                                          Values&);

}  // namespace cairn
