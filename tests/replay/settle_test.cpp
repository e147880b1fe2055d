// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/replay/settle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "cairn/factors/factor_codec.hpp"
#include "cairn/io/graph_file.hpp"
#include "cairn/replay/graph_transactions.hpp"
#include "cairn/replay/map_head.hpp"
#include "cairn/solver/optimize.hpp"
#include "tests/support/datasets.hpp"

namespace cairn {
namespace {

NodeId node_of(VariableId id) { return {{"robot", 1}, id.value}; }

MapHead replay(std::vector<Transaction> transactions) {
  MapHead head;
  std::uint64_t number = 0;
  for (Transaction& transaction : transactions) {
    transaction.key.source = "file";
    const auto refusal = head.check(transaction);
    EXPECT_FALSE(refusal.has_value()) << refusal->reason;
    if (refusal) break;
    head.apply(transaction, {1, 0, ++number});
  }
  return head;
}

std::vector<double> bits(const SettledEstimate& settled) {
  std::vector<double> all;
  for (VariableSlot slot = 0; slot < settled.graph.variables().size(); ++slot) {
    for (const double x : describe_value(settled.graph, slot)) all.push_back(x);
  }
  return all;
}

class PublicGraph : public ::testing::TestWithParam<const char*> {};

TEST_P(PublicGraph, SettlesWhereTheBatchOptimizerEnds) {
  const auto path = test::dataset(GetParam());
  if (!path) GTEST_SKIP() << "data set absent";
  Result<GraphDocument> document = read_graph(path->string());
  ASSERT_TRUE(document) << document.error().to_string();
  const MapHead head = replay(graph_transactions(document->graph, node_of));
  EXPECT_EQ(head.graph().nodes.size(), document->graph.variables().size());
  EXPECT_EQ(head.graph().factors.size(), document->graph.factor_count());
  const SettledEstimate settled = settle(head.graph());
  ASSERT_TRUE(settled.summary.usable());
  const double optimum = optimize(document->graph, {.init = InitMethod::kAuto}).final_chi2;
  EXPECT_NEAR(settled.summary.final_chi2, optimum, 1e-6 * optimum);
}

INSTANTIATE_TEST_SUITE_P(Replayed, PublicGraph,
                         ::testing::Values("graphs/pose2/manhattan.g2o", "graphs/pose2/intel.g2o",
                                           "graphs/pose3/sphere2500.g2o",
                                           "graphs/landmarks/victoriaPark.txt"));

// Two robots, or two epochs of one that begin alike, whose transactions arrive in any order, under
// any epoch and any name of the sender.
class Arrivals : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Of, Arrivals, testing::Values("beta", "alpha"));

TEST_P(Arrivals, SettleToTheSameBitsWhateverTheirOrder) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 0.1);
  std::vector<Transaction> robots[2];
  for (int r = 0; r < 2; ++r) {
    for (std::uint64_t i = 0; i < 40; ++i) {
      Transaction step;
      NewVariable pose;
      pose.node = {{r == 0 ? "alpha" : GetParam(), 0}, i};
      pose.start = {static_cast<double>(i), i == 0 ? 0.0 : r + noise(random), 0.0};
      step.variables.push_back(pose);
      const auto tie = [&](std::uint64_t to, FactorKind kind) {
        NewFactor factor;
        factor.type = FactorType{1};
        factor.kind = kind;
        factor.nodes = {{pose.node.frame, to}, pose.node};
        factor.numbers = {static_cast<double>(i - to) + noise(random),
                          noise(random),
                          0.0,
                          10.0,
                          0.0,
                          0.0,
                          10.0,
                          0.0,
                          50.0};
        step.factors.push_back(factor);
      };
      if (i > 0) tie(i - 1, FactorKind::kOdometry);
      if (i > 10) tie(i - 10, FactorKind::kLoop);
      robots[r].push_back(step);
    }
  }
  const auto run = [&](std::uint64_t epoch, const std::string& prefix, bool beta_first) {
    MapHead head;
    std::uint64_t number = 0;
    for (const int r : beta_first ? std::vector{1, 0} : std::vector{0, 1}) {
      for (std::size_t i = 0; i < robots[r].size(); ++i) {
        Transaction step = robots[r][i];
        step.key = {prefix + std::to_string(r), epoch, i + 1};
        const std::uint64_t own_epoch = beta_first ? epoch - r : epoch + r;
        for (NewVariable& variable : step.variables) variable.node.frame.epoch = own_epoch;
        for (NewFactor& factor : step.factors)
          for (NodeId& node : factor.nodes) node.frame.epoch = own_epoch;
        const auto refusal = head.check(step);
        EXPECT_FALSE(refusal) << refusal->reason;
        head.apply(step, {1, 0, ++number});
      }
    }
    return bits(settle(head.graph()));
  };
  const std::vector<double> expected = run(5, "a", false);
  EXPECT_EQ(run(5, "a", true), expected);
  EXPECT_EQ(run(999, "zz", true), expected);
}

TEST(Settle, LeavesOutDisabledFactors) {
  const auto with_loop = [](bool loop, bool disable) {
    std::vector<Transaction> steps(4);
    for (std::uint64_t i = 0; i < 3; ++i) {
      NewVariable pose;
      pose.node = node_of(VariableId{i});
      pose.start = {static_cast<double>(i), 0.0, 0.0};
      steps[i].variables.push_back(pose);
      steps[i].key.sequence = i + 1;
      if (i == 0) continue;
      NewFactor step;
      step.type = FactorType{1};
      step.kind = FactorKind::kOdometry;
      step.nodes = {node_of(VariableId{i - 1}), pose.node};
      step.numbers = {1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0};
      steps[i].factors.push_back(step);
    }
    if (loop) {
      NewFactor wrong = steps[2].factors[0];
      wrong.kind = FactorKind::kLoop;
      wrong.nodes = {node_of(VariableId{0}), node_of(VariableId{2})};
      steps[2].factors.push_back(wrong);
    }
    steps[3].key.sequence = 4;
    if (disable) steps[3].edits.push_back({{{"file", 0, 3}, 1}, FactorChange::kDisable});
    return bits(settle(replay(steps).graph()));
  };
  EXPECT_NE(with_loop(true, false), with_loop(false, false));
  EXPECT_EQ(with_loop(true, true), with_loop(false, false));
}

}  // namespace
}  // namespace cairn
