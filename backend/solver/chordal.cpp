// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/chordal.hpp"

#include <cmath>
#include <type_traits>

#include "cairn/linear/linear_solver.hpp"

namespace cairn {
namespace {

// Least squares over sum_e weight_e |x_b - M_e x_a - c_e|^2, with one d x d matrix M per edge and k
// right-hand sides, over the poses that are not held. The same blocks for every d, so one
// elimination serves all.
template <class Pose>
class EdgeLeastSquares {
 public:
  EdgeLeastSquares(const RelativePoseGraph<Pose>& graph, const Elimination& known, Kernel kernel)
      : graph_(graph), kernel_(kernel), block_of_(graph.held.size(), -1) {
    int blocks = 0;
    for (std::size_t pose = 0; pose < graph.held.size(); ++pose) {
      if (!graph.held[pose]) block_of_[pose] = blocks++;
    }
    std::vector<std::pair<int, int>> pairs;
    for (const auto& edge : graph.edges) {
      const int a = block_of_[edge.measured.a], b = block_of_[edge.measured.b];
      if (a >= 0 && b >= 0) pairs.emplace_back(a, b);
    }
    blocks_ = BlockGraph::from_pairs(blocks, pairs);
    elimination_ = known.position.size() == static_cast<std::size_t>(blocks)
                       ? known
                       : find_elimination(blocks_);
  }

  // x holds d rows per pose; the rows of held poses are given, the others are solved for.
  // matrix(edge) is M, constant(edge) is c (d x k), weight(edge) > 0.
  template <int d, int k, class Matrix, class Constant, class Weight>
  bool solve(Eigen::Matrix<double, Eigen::Dynamic, k>& x, Matrix matrix, Constant constant,
             Weight weight) const {
    const std::vector<int> dimensions(static_cast<std::size_t>(blocks_.size()), d);
    const BlockPattern pattern = BlockPattern::build(blocks_, elimination_.position, dimensions);
    std::vector<double> values(pattern.value_count(), 0.0);
    Eigen::Matrix<double, Eigen::Dynamic, k> rhs(pattern.scalar_size(), k);
    rhs.setZero();
    using Block = Eigen::Matrix<double, d, d>;
    using Rows = Eigen::Matrix<double, d, k>;
    const auto block = [&](int entry, int column) {
      return Eigen::Map<Block, 0, Eigen::OuterStride<>>(
          values.data() + pattern.value_begin[column] +
              static_cast<std::size_t>(pattern.row_offset[entry]),
          Eigen::OuterStride<>(pattern.height[column]));
    };
    for (const auto& edge : graph_.edges) {
      const double w = weight(edge);
      const Block M = matrix(edge);
      const Rows c = constant(edge);
      const int a = position(edge.measured.a), b = position(edge.measured.b);
      const Rows x_a = x.template middleRows<d>(d * edge.measured.a);
      const Rows x_b = x.template middleRows<d>(d * edge.measured.b);
      if (a >= 0) {
        block(pattern.column_begin[a], a) += w * (M.transpose() * M);
        rhs.template middleRows<d>(d * a) +=
            w * M.transpose() * ((b < 0 ? x_b : Rows(Rows::Zero())) - c);
      }
      if (b >= 0) {
        block(pattern.column_begin[b], b) += w * Block::Identity();
        rhs.template middleRows<d>(d * b) += w * (c + (a < 0 ? Rows(M * x_a) : Rows(Rows::Zero())));
      }
      if (a < 0 || b < 0) continue;
      if (a > b)
        block(pattern.find(a, b), b) -=
            w * M.transpose();  // block (a, b) couples row a with column b
      else
        block(pattern.find(b, a), a) -= w * M;
    }
    const std::unique_ptr<LinearSolver> linear = make_multifrontal_solver(kernel_);
    linear->analyze(pattern, elimination_);
    if (!linear->factorize(values.data())) return false;
    for (int column = 0; column < k; ++column)
      linear->solve(rhs.col(column).data(), rhs.col(column).data());
    for (std::size_t pose = 0; pose < block_of_.size(); ++pose) {
      if (block_of_[pose] < 0) continue;
      const auto index = static_cast<std::uint32_t>(pose);
      x.template middleRows<d>(d * index) = rhs.template middleRows<d>(d * position(index));
    }
    return rhs.allFinite();
  }

 private:
  [[nodiscard]] int position(std::uint32_t pose) const {
    return block_of_[pose] < 0 ? -1 : elimination_.position[block_of_[pose]];
  }

  const RelativePoseGraph<Pose>& graph_;
  Kernel kernel_;
  std::vector<int> block_of_;
  BlockGraph blocks_;
  Elimination elimination_;
};

using Edge2 = RelativePoseGraph<Se2>::Edge;
using Edge3 = RelativePoseGraph<Se3>::Edge;

// Rotations in the plane as (cos, sin), which relaxes to any point: x_b = R(measured) x_a.
bool solve_rotations(const RelativePoseGraph<Se2>& graph, const EdgeLeastSquares<Se2>& system,
                     std::vector<So2>& rotations) {
  Eigen::VectorXd x(2 * graph.held.size());
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    x.middleRows<2>(static_cast<Eigen::Index>(2 * i)) =
        Eigen::Vector2d(rotations[i].cos(), rotations[i].sin());
  }
  const bool solved = system.solve<2, 1>(
      x, [](const Edge2& edge) { return edge.measured.T_a_b.rotation().matrix(); },
      [](const Edge2&) { return Eigen::Vector2d::Zero(); },
      [](const Edge2& edge) { return edge.measured.rotation_weight; });
  if (!solved) return false;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    if (!graph.held[i]) rotations[i] = So2(std::atan2(x[row + 1], x[row]));
  }
  return true;
}

// Rotations in space as the columns of R^T, one right-hand side per row of R: x_b = R(measured)^T
// x_a.
bool solve_rotations(const RelativePoseGraph<Se3>& graph, const EdgeLeastSquares<Se3>& system,
                     std::vector<So3>& rotations) {
  Eigen::Matrix<double, Eigen::Dynamic, 3> x(3 * graph.held.size(), 3);
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    x.middleRows<3>(static_cast<Eigen::Index>(3 * i)) = rotations[i].matrix().transpose();
  }
  const bool solved = system.solve<3, 3>(
      x,
      [](const Edge3& edge) {
        return Eigen::Matrix3d(edge.measured.T_a_b.rotation().matrix().transpose());
      },
      [](const Edge3&) { return Eigen::Matrix3d::Zero(); },
      [](const Edge3& edge) { return edge.measured.rotation_weight; });
  if (!solved) return false;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    if (!graph.held[i])
      rotations[i] = So3::project(x.middleRows<3>(static_cast<Eigen::Index>(3 * i)).transpose());
  }
  return true;
}

// Poses to hold where a component of relative poses has none held: its smallest id.
template <class Pose>
std::vector<std::uint32_t> roots_to_hold(const RelativePoseGraph<Pose>& graph) {
  std::vector<bool> reached = graph.held;
  std::vector<std::uint32_t> stack, roots;
  const auto spread = [&] {
    while (!stack.empty()) {
      const std::uint32_t pose = stack.back();
      stack.pop_back();
      for (std::uint32_t k = graph.incidence_begin[pose]; k < graph.incidence_begin[pose + 1];
           ++k) {
        const std::uint32_t other = graph.incidences[k].other;
        if (reached[other]) continue;
        reached[other] = true;
        stack.push_back(other);
      }
    }
  };
  for (std::uint32_t pose = 0; pose < graph.held.size(); ++pose) {
    if (graph.held[pose]) stack.push_back(pose);
  }
  spread();
  for (const std::uint32_t pose : graph.poses_by_id) {
    if (reached[pose]) continue;
    reached[pose] = true;
    roots.push_back(pose);
    stack.push_back(pose);
    spread();
  }
  return roots;
}

}  // namespace

template <class Pose>
bool chordal_poses(const RelativePoseGraph<Pose>& source, const Elimination& known, Kernel kernel,
                   std::vector<Pose>& poses) {
  if (poses.empty()) return true;
  RelativePoseGraph<Pose> graph = source;
  for (const std::uint32_t root : roots_to_hold(source)) graph.held[root] = true;
  constexpr int d = std::is_same_v<Pose, Se2> ? 2 : 3;
  using Rotation = std::remove_cvref_t<decltype(poses[0].rotation())>;
  using Translation = Eigen::Matrix<double, d, 1>;
  const EdgeLeastSquares<Pose> system(graph, known, kernel);
  std::vector<Rotation> rotations;
  rotations.reserve(poses.size());
  Eigen::Matrix<double, Eigen::Dynamic, d> positions(poses.size(), d);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    rotations.push_back(poses[i].rotation());
    positions.row(static_cast<Eigen::Index>(i)) = poses[i].translation();
  }
  if (!solve_rotations(graph, system, rotations)) return false;
  using Edge = typename RelativePoseGraph<Pose>::Edge;
  const bool solved = system.template solve<1, d>(
      positions, [](const Edge&) { return Eigen::Matrix<double, 1, 1>::Identity(); },
      [&](const Edge& edge) -> Eigen::Matrix<double, 1, d> {
        const Translation moved = rotations[edge.measured.a] * edge.measured.T_a_b.translation();
        return moved.transpose();
      },
      [](const Edge& edge) { return edge.measured.translation_weight; });
  if (!solved) return false;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    poses[i] =
        Pose(rotations[i], Translation(positions.row(static_cast<Eigen::Index>(i)).transpose()));
  }
  return true;
}

template bool chordal_poses(const RelativePoseGraph<Se2>&, const Elimination&, Kernel,
                            std::vector<Se2>&);
template bool chordal_poses(const RelativePoseGraph<Se3>&, const Elimination&, Kernel,
                            std::vector<Se3>&);

}  // namespace cairn
