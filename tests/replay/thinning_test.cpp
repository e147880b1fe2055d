// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/replay/thinning.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "cairn/factors/build_transaction.hpp"
#include "cairn/factors/factor_codec.hpp"
#include "cairn/replay/graph_transactions.hpp"
#include "cairn/replay/map_head.hpp"
#include "cairn/replay/settle.hpp"
#include "cairn/solver/marginals.hpp"
#include "datasets/simulate.hpp"

namespace cairn {
namespace {

constexpr const char* kOwn = ".own";

class ThinnedMap {
 public:
  void take(Transaction transaction, const std::string& source = "robot") {
    transaction.key = {source, 1, ++sequence_};
    const auto refusal = head_.check(transaction);
    ASSERT_FALSE(refusal) << refusal->reason;
    head_.apply(transaction, next());
  }
  void commit_loops() { head_.commit_loops(head_.graph().graph_revision); }
  void take_solution(const SettledEstimate& settled) {
    head_.apply_estimates(changed_estimates(head_.graph(), settled), head_.graph().graph_revision,
                          next());
  }
  // As a daemon does with a plan.
  void take_out(const Thinning& plan) {
    std::vector<FactorEdit> edits;
    const auto& factors = head_.graph().factors;
    for (std::size_t f = 0; f < factors.size(); ++f)
      for (const NodeIndex node : factors[f].nodes)
        if (std::binary_search(plan.nodes.begin(), plan.nodes.end(), node))
          edits.push_back({factors[f].name, FactorChange::kDisable});
    Transaction made;
    made.factors = plan.factors;
    take(std::move(made), kOwn);
    commit_loops();
    head_.apply(edits, next());
  }
  [[nodiscard]] const PoseGraph& graph() const { return head_.graph(); }

 private:
  Revision next() { return {1, 0, ++number_}; }

  MapHead head_;
  std::uint64_t number_ = 0, sequence_ = 0;
};

NodeId node(std::uint64_t index) { return {{"robot", 1}, index}; }

Eigen::Matrix3d information(double scale) {
  Eigen::Matrix3d m;
  m << 4.0, 1.0, 0.5, 1.0, 3.0, -0.4, 0.5, -0.4, 9.0;
  return scale * m;
}

// Of the poses `kept` relative to the first of them, at any values: by the whole factors.
Eigen::MatrixXd covariance(Graph& graph, const std::vector<std::uint64_t>& kept) {
  const auto slot = [&](std::uint64_t id) { return *graph.find(VariableId{id}); };
  graph.set_fixed(slot(kept[0]), true);
  const auto marginals = Marginals::compute(graph);
  EXPECT_TRUE(marginals);
  const auto n = static_cast<Eigen::Index>(kept.size()) - 1;
  Eigen::MatrixXd all(3 * n, 3 * n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < n; ++k) {
      const auto a = slot(kept[static_cast<std::size_t>(i) + 1]);
      const auto b = slot(kept[static_cast<std::size_t>(k) + 1]);
      all.block<3, 3>(3 * i, 3 * k) = i == k
                                          ? marginals->covariance(a)
                                          : marginals->joint_covariance(a, b).topRightCorner(3, 3);
    }
  return all;
}

double log_det(const Eigen::MatrixXd& m) {
  return 2.0 * m.llt().matrixLLT().diagonal().array().log().sum();
}

TEST(Thinning, SaysWhatItLoses) {
  Graph graph;
  std::vector<std::uint64_t> neighbors{99, 101, 200, 300};
  const Se2 T_99_100(0.1, 0.02, 0.01), T_100_101(0.2, -0.02, 0.03);
  const Se2 T_100_200(0.3, -0.2, 0.4), T_300_100(-0.1, 0.5, 0.1);
  const auto add = [&](std::uint64_t id, const Se2& T) {
    const Eigen::Vector3d v = T.to_vector();
    ASSERT_TRUE(add_variable(graph, VariableId{id}, VariableType::kPose2, {v.data(), 3}));
  };
  add(100, Se2());
  add(99, T_99_100.inverse());
  add(101, T_100_101);
  add(200, T_100_200);
  add(300, T_300_100.inverse());
  const auto tie = [](Graph& to, std::uint64_t a, std::uint64_t b, const Se2& T,
                      const Eigen::Matrix3d& omega) {
    Transaction one;
    add_between(one, node(a), node(b), T, omega);
    const VariableId ids[] = {VariableId{a}, VariableId{b}};
    ASSERT_TRUE(add_factor(to, one.factors[0], ids));
  };
  tie(graph, 99, 100, T_99_100, information(1.0 + 100 % 7));
  tie(graph, 100, 101, T_100_101, information(1.0 + 101 % 7));
  tie(graph, 100, 200, T_100_200, information(2.0));
  tie(graph, 300, 100, T_300_100, information(3.0));
  Graph tree;
  const Eigen::MatrixXd exact = covariance(graph, neighbors);
  // The plan for a map in which 100 is the only one that can go.
  ThinnedMap only;
  Transaction alone;
  for (const std::uint64_t i : {98, 99, 100, 101}) add_pose(alone, node(i), Se2());
  for (std::uint64_t i = 102; i < 400; ++i)
    add_pose(alone, node(i), i == 200 || i == 300 || i == 350 ? Se2() : Se2(1e5, 0.0, 0.0));
  add_between(alone, node(99), node(100), T_99_100, information(1.0 + 100 % 7));
  add_between(alone, node(100), node(101), T_100_101, information(1.0 + 101 % 7));
  add_between(alone, node(100), node(200), T_100_200, information(2.0), FactorKind::kLoop);
  add_between(alone, node(300), node(100), T_300_100, information(3.0), FactorKind::kLoop);
  only.take(alone);
  only.commit_loops();
  const Thinning plan = plan_thinning(
      only.graph(), kOwn, {.visits = 2, .radius_m = 1.0, .angle_rad = 1.0, .at_most = 1});
  ASSERT_EQ(plan.nodes, std::vector<NodeIndex>{2});
  ASSERT_EQ(plan.factors.size(), 3u);
  EXPECT_EQ(plan.factors[0].kind, FactorKind::kOdometry);
  for (const std::uint64_t id : neighbors) {
    const auto value = describe_value(graph, *graph.find(VariableId{id}));
    ASSERT_TRUE(add_variable(tree, VariableId{id}, VariableType::kPose2, value));
  }
  for (const NewFactor& factor : plan.factors) {
    const VariableId ids[] = {VariableId{factor.nodes[0].index}, VariableId{factor.nodes[1].index}};
    ASSERT_TRUE(add_factor(tree, factor, ids));
  }
  const Eigen::MatrixXd kept = covariance(tree, neighbors);
  const Eigen::MatrixXd ratio = kept.llt().solve(exact);
  const double lost =
      0.5 * (ratio.trace() - static_cast<double>(exact.rows()) + log_det(kept) - log_det(exact));
  EXPECT_GT(lost, 0.05);
  EXPECT_NEAR(plan.information_lost, lost, 1e-9);
}

TEST(Thinning, OfAPoseBetweenTwoLosesNothing) {
  ThinnedMap map;
  Transaction all;
  for (std::uint64_t i = 0; i < 200; ++i) {
    add_pose(all, node(i),
             Se2(i == 5 || i > 100 ? 0.0 : 1e4 + 10.0 * static_cast<double>(i), 0, 0));
    if (i > 0) add_between(all, node(i - 1), node(i), Se2(0.1, 0.02, 0.01), information(2.0));
  }
  map.take(all);
  const Thinning plan = plan_thinning(
      map.graph(), kOwn, {.visits = 3, .radius_m = 1e3, .angle_rad = 4.0, .at_most = 1});
  ASSERT_EQ(plan.nodes, std::vector<NodeIndex>{1});
  ASSERT_EQ(plan.factors.size(), 1u);
  EXPECT_LT(plan.information_lost, 1e-12);
  const Se2 T = Se2(0.1, 0.02, 0.01) * Se2(0.1, 0.02, 0.01);
  EXPECT_NEAR(plan.factors[0].numbers[0], T.x(), 1e-12);
  EXPECT_NEAR(plan.factors[0].numbers[1], T.y(), 1e-12);
  EXPECT_NEAR(plan.factors[0].numbers[2], T.theta(), 1e-12);
}

class World3 : public ::testing::TestWithParam<World> {};

// Many visits to the same places: half of the poses go, and the others stay where they were.
TEST_P(World3, KeepsTheMapWhereItWas) {
  const auto world = simulate({.world = GetParam(), .poses = 1200, .seed = 3});
  ASSERT_TRUE(world);
  ThinnedMap map;
  for (Transaction& step :
       graph_transactions(world->graph, [](VariableId id) { return node(id.value); }))
    map.take(std::move(step));
  map.commit_loops();
  const SettledEstimate before = settle(map.graph(), {.gate = Gate::kOpen});
  map.take_solution(before);
  const PoseGraph whole = map.graph();
  const ThinningOptions how{.visits = 1, .radius_m = 1.5, .angle_rad = 3.2, .at_most = 2000};
  const Thinning plan = plan_thinning(whole, kOwn, how);
  EXPECT_GT(plan.nodes.size(), 100u);
  EXPECT_GT(plan.information_lost, 0.0);
  EXPECT_LT(plan.information_lost, 1.5 * static_cast<double>(plan.nodes.size()));
  map.take_out(plan);
  const SettledEstimate after = settle(map.graph(), {.gate = Gate::kOpen});
  ASSERT_TRUE(after.summary.usable());
  EXPECT_EQ(after.order.nodes.size(), before.order.nodes.size() - plan.nodes.size());
  EXPECT_LT(after.order.factors.size(), before.order.factors.size());
  double squares = 0.0;
  for (const auto& [index, estimate] : estimates_of(map.graph(), after))
    squares += Eigen::Map<const Eigen::Vector3d>(estimate.data())
                   .head<2>()
                   .eval()
                   .
                   operator-(Eigen::Map<const Eigen::Vector2d>(whole.estimates[index].data()))
                   .squaredNorm();
  EXPECT_LT(std::sqrt(squares / static_cast<double>(after.order.nodes.size())), 0.1);
  // And the gate finds nothing wrong with what is left.
  const SettledEstimate gated = settle(map.graph());
  ASSERT_TRUE(gated.summary.usable());
  for (const LoopVerdict& verdict : gated.verdicts)
    EXPECT_EQ(verdict.state, FactorState::kCommitted) << verdict.test;
}

INSTANTIATE_TEST_SUITE_P(Worlds, World3, ::testing::Values(World::kManhattan, World::kGrid));

}  // namespace
}  // namespace cairn
