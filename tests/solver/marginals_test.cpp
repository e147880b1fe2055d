// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/marginals.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>
#include <utility>
#include <vector>

#include "cairn/factors/between.hpp"
#include "cairn/factors/landmark_xy.hpp"
#include "cairn/factors/landmark_xyz.hpp"
#include "cairn/solver/optimize.hpp"
#include "tests/solver/small_problems.hpp"

namespace cairn {
namespace {

using test::RandomNumbers;

// A chain of poses with one loop closure, and landmarks seen from two poses each; residuals are not
// zero.
Graph plane(std::uint64_t poses, std::uint64_t landmarks, std::uint32_t seed) {
  RandomNumbers random(seed);
  Graph graph;
  for (std::uint64_t i = 0; i < poses; ++i) {
    EXPECT_TRUE(graph.add_pose2({i}, Se2::exp(random.vector<3>(1.5))));
  }
  const auto connect = [&](std::uint64_t a, std::uint64_t b) {
    const Se2 T_a_b = graph.values().pose2[a].inverse() * graph.values().pose2[b];
    const BetweenSe2 edge{T_a_b.retract(random.vector<3>(0.1)), random.information<3>()};
    EXPECT_TRUE(graph.add_factor(edge, {VariableId{a}, VariableId{b}}));
  };
  for (std::uint64_t i = 1; i < poses; ++i) connect(i - 1, i);
  connect(poses - 1, poses / 3);
  for (std::uint64_t l = 0; l < landmarks; ++l) {
    EXPECT_TRUE(graph.add_point2({1000 + l}, random.vector<2>(2.0)));
    for (const std::uint64_t pose : {l % poses, (3 * l + 2) % poses}) {
      const LandmarkXy seen{random.vector<2>(2.0), {}, random.information<2>()};
      EXPECT_TRUE(graph.add_factor(seen, {VariableId{pose}, VariableId{1000 + l}}));
    }
  }
  return graph;
}

Graph space(std::uint64_t poses, std::uint64_t landmarks, std::uint32_t seed) {
  RandomNumbers random(seed);
  Graph graph;
  for (std::uint64_t i = 0; i < poses; ++i) {
    EXPECT_TRUE(graph.add_pose3({i}, Se3::exp(random.vector<6>(0.8))));
  }
  const auto connect = [&](std::uint64_t a, std::uint64_t b) {
    const Se3 T_a_b = graph.values().pose3[a].inverse() * graph.values().pose3[b];
    const BetweenSe3 edge{T_a_b.retract(random.vector<6>(0.1)), random.information<6>()};
    EXPECT_TRUE(graph.add_factor(edge, {VariableId{a}, VariableId{b}}));
  };
  for (std::uint64_t i = 1; i < poses; ++i) connect(i - 1, i);
  connect(poses - 1, poses / 3);
  for (std::uint64_t l = 0; l < landmarks; ++l) {
    EXPECT_TRUE(graph.add_point3({1000 + l}, random.vector<3>(2.0)));
    for (const std::uint64_t pose : {l % poses, (3 * l + 2) % poses}) {
      const LandmarkXyz seen{random.vector<3>(2.0), {}, random.information<3>()};
      EXPECT_TRUE(graph.add_factor(seen, {VariableId{pose}, VariableId{1000 + l}}));
    }
  }
  return graph;
}

/// The referee: all covariances by dense inversion of J^T J, held variables left out.
class DenseCovariance {
 public:
  DenseCovariance(const Graph& graph, const std::vector<bool>& held) : begin_(held.size(), -1) {
    for (std::size_t slot = 0; slot < held.size(); ++slot) {
      if (held[slot]) continue;
      begin_[slot] = size_;
      size_ += tangent_dimension(graph.variables()[slot].type);
    }
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size_, size_);
    const EvaluationContext context{.values = graph.values()};
    for (const FactorRef factor : graph.factors()) {
      const FactorEvaluation evaluation =
          graph.batches()[factor.batch]->evaluate(factor.index, context);
      const std::vector<VariableSlot> slots = graph.slots_of(factor);
      for (std::size_t k = 0; k < slots.size(); ++k) {
        for (std::size_t l = 0; l < slots.size(); ++l) {
          if (held[slots[k]] || held[slots[l]]) continue;
          const Eigen::MatrixXd &J_k = evaluation.jacobians[k], &J_l = evaluation.jacobians[l];
          H.block(begin_[slots[k]], begin_[slots[l]], J_k.cols(), J_l.cols()) +=
              J_k.transpose() * J_l;
        }
      }
    }
    covariance_ = H.inverse();
  }

  [[nodiscard]] Eigen::MatrixXd block(const Graph& graph, VariableSlot a, VariableSlot b) const {
    const int d_a = tangent_dimension(graph.variables()[a].type),
              d_b = tangent_dimension(graph.variables()[b].type);
    if (begin_[a] < 0 || begin_[b] < 0) return Eigen::MatrixXd::Zero(d_a, d_b);
    return covariance_.block(begin_[a], begin_[b], d_a, d_b);
  }

 private:
  int size_ = 0;
  std::vector<int> begin_;
  Eigen::MatrixXd covariance_;
};

void expect_dense_covariances(const Graph& graph, const std::vector<bool>& held) {
  const Result<Marginals> marginals = Marginals::compute(graph);
  ASSERT_TRUE(marginals) << marginals.error().to_string();
  const DenseCovariance dense(graph, held);
  for (VariableSlot a = 0; a < held.size(); ++a) {
    for (VariableSlot b = 0; b < held.size(); ++b) {
      const Eigen::MatrixXd joint = marginals->joint_covariance(a, b);
      const Eigen::MatrixXd cross = dense.block(graph, a, b);
      const double scale = 1.0 + dense.block(graph, a, a).norm() + dense.block(graph, b, b).norm();
      EXPECT_LT((joint.topRightCorner(cross.rows(), cross.cols()) - cross).norm(), 1e-11 * scale)
          << a << ", " << b;
      EXPECT_EQ(joint, joint.transpose()) << a << ", " << b;
    }
    EXPECT_LT((marginals->covariance(a) - dense.block(graph, a, a)).norm(), 1e-10) << a;
  }
}

TEST(Marginals, EqualDenseInversionForPosesAndLandmarksInThePlane) {
  const Graph graph = plane(12, 7, 1);
  std::vector<bool> held(graph.variables().size(), false);
  held[0] = true;  // the gauge: smallest id
  expect_dense_covariances(graph, held);
}

TEST(Marginals, EqualDenseInversionForPosesAndLandmarksInSpace) {
  const Graph graph = space(9, 5, 2);
  std::vector<bool> held(graph.variables().size(), false);
  held[0] = true;
  expect_dense_covariances(graph, held);
}

TEST(Marginals, AreZeroForFixedVariablesAndRelativeToThem) {
  Graph graph = plane(12, 7, 3);
  std::vector<bool> held(graph.variables().size(), false);
  for (const VariableSlot slot : {5u, 14u}) {  // a pose and a landmark; then no gauge is added
    graph.set_fixed(slot, true);
    held[slot] = true;
  }
  expect_dense_covariances(graph, held);
}

// d(T_a_b) in its own tangent space by central differences, times the dense joint covariance.
template <class Pose, int N>
Eigen::MatrixXd numeric_relative_covariance(const Pose& T_map_a, const Pose& T_map_b,
                                            const Eigen::MatrixXd& joint) {
  const Pose T_a_b = T_map_a.inverse() * T_map_b;
  const double h = 1e-6;
  const auto change = [&](int k, double step) -> Eigen::VectorXd {
    Eigen::VectorXd d = Eigen::VectorXd::Zero(2 * N);
    d[k] = step;
    const Pose moved = T_map_a.retract(d.head(N)).inverse() * T_map_b.retract(d.tail(N));
    return (T_a_b.inverse() * moved).log();
  };
  Eigen::MatrixXd J(N, 2 * N);
  for (int k = 0; k < 2 * N; ++k) J.col(k) = (change(k, h) - change(k, -h)) / (2.0 * h);
  return J * joint * J.transpose();
}

TEST(Marginals, RelativeCovarianceIsThatOfThePoseDifferenceInItsTangentSpace) {
  const Graph graph2 = plane(12, 3, 4), graph3 = space(9, 3, 5);
  const Marginals of2 = std::move(Marginals::compute(graph2)).value();
  const Marginals of3 = std::move(Marginals::compute(graph3)).value();
  for (VariableSlot a = 0; a < 9; ++a) {
    for (VariableSlot b = 0; b < 9; ++b) {
      if (a == b) continue;
      const auto& poses2 = graph2.values().pose2;
      const auto& poses3 = graph3.values().pose3;
      const Eigen::MatrixXd expected2 =
          numeric_relative_covariance<Se2, 3>(poses2[a], poses2[b], of2.joint_covariance(a, b));
      const Eigen::MatrixXd expected3 =
          numeric_relative_covariance<Se3, 6>(poses3[a], poses3[b], of3.joint_covariance(a, b));
      // Central differences are good to about 1e-9 of the numbers that go in.
      EXPECT_LT((of2.relative_covariance(a, b) - expected2).norm(), 1e-6 * (1.0 + expected2.norm()))
          << a << ", " << b;
      EXPECT_LT((of3.relative_covariance(a, b) - expected3).norm(), 1e-6 * (1.0 + expected3.norm()))
          << a << ", " << b;
    }
  }
}

TEST(Marginals, RelativeCovarianceDoesNotDependOnTheGauge) {
  Graph graph = plane(15, 0, 6);
  optimize(graph);
  const Marginals first = std::move(Marginals::compute(graph)).value();
  graph.set_fixed(9, true);
  const Marginals other = std::move(Marginals::compute(graph)).value();
  for (VariableSlot b = 1; b < 15; ++b) {
    const Eigen::MatrixXd expected = first.relative_covariance(b - 1, b);
    EXPECT_LT((other.relative_covariance(b - 1, b) - expected).norm(), 1e-9 * expected.norm()) << b;
  }
  EXPECT_EQ(other.covariance(9), Eigen::MatrixXd::Zero(3, 3));
}

TEST(Marginals, AreNanForWhatTheMeasurementsLeaveFreeAndUnchangedForTheRest) {
  Graph graph = plane(12, 3, 7);
  const Marginals before = std::move(Marginals::compute(graph)).value();
  ASSERT_TRUE(graph.add_point2({5000}, Eigen::Vector2d(1.0, 2.0)));
  const LandmarkXy one_axis{Eigen::Vector2d(1.0, 1.0), {}, Eigen::Vector2d(4.0, 0.0).asDiagonal()};
  ASSERT_TRUE(graph.add_factor(one_axis, {VariableId{4}, VariableId{5000}}));
  const Result<Marginals> after = Marginals::compute(graph);
  ASSERT_TRUE(after) << after.error().to_string();
  const VariableSlot free = *graph.find({5000});
  EXPECT_TRUE(after->covariance(free).array().isNaN().all());
  EXPECT_TRUE(after->joint_covariance(3, free).topRightCorner(3, 2).array().isNaN().all());
  for (VariableSlot slot = 0; slot < free; ++slot) {
    EXPECT_LT((after->covariance(slot) - before.covariance(slot)).norm(), 1e-9) << slot;
  }
}

TEST(Marginals, OfAChainGrowAlongIt) {
  Graph graph;
  ASSERT_TRUE(graph.add_pose2({0}, Se2()));
  for (std::uint64_t i = 1; i < 30; ++i) {
    ASSERT_TRUE(graph.add_pose2({i}, Se2(static_cast<double>(i), 0.0, 0.0)));
    const BetweenSe2 step{Se2(1.0, 0.0, 0.0), Eigen::Vector3d(100.0, 100.0, 10000.0).asDiagonal()};
    ASSERT_TRUE(graph.add_factor(step, {VariableId{i - 1}, VariableId{i}}));
  }
  const Marginals marginals = std::move(Marginals::compute(graph)).value();
  // Along the way the errors of 29 steps add up; sideways the headings' do too.
  EXPECT_NEAR(marginals.covariance(29)(0, 0), 29 * 0.01, 1e-12);
  EXPECT_NEAR(marginals.covariance(29)(2, 2), 29 * 1e-4, 1e-14);
  EXPECT_GT(marginals.covariance(29)(1, 1), 0.5);
}

// Against one pair at a time, from the selected inverse.
TEST(Marginals, OfSeveralRelativePosesAreThoseOfEachAndOfTheirSum) {
  const Graph graph = space(12, 3, 5);
  const Result<Marginals> marginals = Marginals::compute(graph);
  ASSERT_TRUE(marginals);
  using Pair = std::pair<VariableSlot, VariableSlot>;
  const std::vector<Pair> pairs{{2, 7}, {11, 3}, {0, 9}};  // 0 is held
  const Eigen::MatrixXd joint = marginals->relative_covariance(pairs);
  ASSERT_EQ(joint.rows(), 18);
  Eigen::MatrixXd stacked(18, 4);
  std::vector<Eigen::MatrixXd> weights;
  RandomNumbers random(1);
  for (int i = 0; i < 3; ++i) {
    const Eigen::MatrixXd alone = marginals->relative_covariance(pairs[i].first, pairs[i].second);
    EXPECT_TRUE(joint.block(6 * i, 6 * i, 6, 6).isApprox(alone, 1e-9));
    weights.emplace_back(6, 4);
    for (int k = 0; k < 4; ++k) weights.back().col(k) = random.vector<6>(1.0);
    stacked.middleRows(6 * i, 6) = weights.back();
  }
  const Eigen::MatrixXd sum = marginals->covariance_of_sum(pairs, weights);
  EXPECT_TRUE(sum.isApprox(stacked.transpose() * joint * stacked, 1e-9));
  // Correlated, for they share odometry: T_2_7 and T_3_7 in one chain.
  const Eigen::MatrixXd near = marginals->relative_covariance(std::vector<Pair>{{2, 7}, {3, 7}});
  EXPECT_GT(near.topRightCorner(6, 6).norm(), 0.1 * near.topLeftCorner(6, 6).norm());
}

}  // namespace
}  // namespace cairn
