// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/graph/graph.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "cairn/factors/between.hpp"
#include "cairn/factors/landmark_xy.hpp"
#include "cairn/factors/prior.hpp"
#include "tests/support/random_graph.hpp"

namespace cairn::test {
namespace {

const BetweenSe2 kStep{Se2(1.0, 0.0, 0.0), Eigen::Matrix3d::Identity()};

Graph line_of_poses(std::initializer_list<std::uint64_t> ids) {
  Graph graph;
  for (const std::uint64_t id : ids) EXPECT_TRUE(graph.add_pose2(VariableId{id}, Se2()).ok());
  return graph;
}

TEST(Graph, FindsVariablesByIdAndKeepsTheirOrder) {
  Graph graph;
  ASSERT_TRUE(graph.add_pose2(VariableId{9}, Se2(1.0, 2.0, 0.5)).ok());
  ASSERT_TRUE(graph.add_point2(VariableId{4}, {3.0, 4.0}).ok());
  ASSERT_TRUE(graph.add_pose2(VariableId{2}, Se2(5.0, 6.0, 0.0)).ok());
  EXPECT_EQ(graph.find(VariableId{9}), 0u);
  EXPECT_EQ(graph.find(VariableId{4}), 1u);
  EXPECT_EQ(graph.find(VariableId{2}), 2u);
  EXPECT_EQ(graph.find(VariableId{7}), std::nullopt);
  EXPECT_EQ(graph.variables()[2].index, 1u);
  EXPECT_EQ(graph.slot_of(VariableType::kPose2, 1), 2u);
  EXPECT_EQ(graph.values().point2[0], Eigen::Vector2d(3.0, 4.0));
}

// Every refusal names what is wrong and leaves the graph as it was.
struct Refusal {
  const char* name;
  std::function<std::optional<Error>(Graph&)> attempt;
  const char* message;
};

template <class T>
std::optional<Error> error_of(const Result<T>& result) {
  if (result.ok()) return std::nullopt;
  return result.error();
}

std::vector<Refusal> refusals() {
  const auto with_information = [](double xx, double xy) {
    BetweenSe2 factor = kStep;
    factor.information(0, 0) = xx;
    factor.information(0, 1) = factor.information(1, 0) = xy;
    return factor;
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const auto between = [](const BetweenSe2& factor, std::uint64_t a, std::uint64_t b) {
    return [=](Graph& graph) {
      return error_of(graph.add_factor(factor, {VariableId{a}, VariableId{b}}));
    };
  };
  return {
      {"same id",
       [](Graph& graph) {
         return error_of(graph.add_point2(VariableId{1}, {0.0, 0.0}));
       },
       "variable 1 is defined twice"},
      {"unknown", between(kStep, 1, 77), "factor refers to variable 77, which is not defined"},
      {"type", between(kStep, 1, 5),
       "variable 5 is a 2-D point, but the factor needs a SE(2) pose"},
      {"self", between(kStep, 1, 1), "factor connects variable 1 with itself"},
      {"nan", between(with_information(kNan, 0.0), 1, 2),
       "between_se2 information is not finite and positive semidefinite"},
      {"inf", between(with_information(kInf, 0.0), 1, 2),
       "between_se2 information is not finite and positive semidefinite"},
      {"indefinite", between(with_information(1.0, 2.0), 1, 2),
       "between_se2 information is not finite and positive semidefinite"},
      {"negative", between(with_information(-1.0, 0.0), 1, 2),
       "between_se2 information is not finite and positive semidefinite"},
  };
}

TEST(Graph, RefusalsNameTheReasonAndLeaveTheGraphUnchanged) {
  for (const Refusal& refusal : refusals()) {
    SCOPED_TRACE(refusal.name);
    Graph graph = line_of_poses({1, 2});
    ASSERT_TRUE(graph.add_point2(VariableId{5}, {1.0, 1.0}).ok());
    const std::optional<Error> error = refusal.attempt(graph);
    ASSERT_TRUE(error.has_value());
    EXPECT_EQ(error->message, refusal.message);
    EXPECT_EQ(error->code, ErrorCode::kBadInput);
    EXPECT_EQ(graph.variables().size(), 3u);
    EXPECT_EQ(graph.values().pose2.size(), 2u);
    EXPECT_EQ(graph.values().point2.size(), 1u);
    EXPECT_EQ(graph.factor_count(), 0u);
    EXPECT_TRUE(graph.batches().empty());
  }
}

TEST(Graph, AcceptsSemidefiniteInformation) {
  Graph graph = line_of_poses({1, 2});
  BetweenSe2 factor = kStep;
  factor.information.setZero();
  EXPECT_TRUE(graph.add_factor(factor, {VariableId{1}, VariableId{2}}).ok());
}

TEST(Graph, KeepsFactorsInOrderOfInsertionAcrossTypes) {
  Graph graph = line_of_poses({1, 2});
  ASSERT_TRUE(graph.add_point2(VariableId{5}, {1.0, 1.0}).ok());
  const LandmarkXy sighting{{1.0, 0.0}, {}, Eigen::Matrix2d::Identity()};
  const PriorXy anchor{{0.0, 0.0}, Eigen::Matrix2d::Identity()};
  ASSERT_TRUE(graph.add_factor(sighting, {VariableId{2}, VariableId{5}}).ok());
  ASSERT_TRUE(graph.add_factor(kStep, {VariableId{2}, VariableId{1}}, FactorKind::kOdometry).ok());
  ASSERT_TRUE(graph.add_factor(sighting, {VariableId{1}, VariableId{5}}).ok());
  ASSERT_TRUE(graph.add_factor(anchor, {VariableId{1}}).ok());
  ASSERT_EQ(graph.factor_count(), 4u);
  std::vector<std::string_view> names;
  for (const FactorRef factor : graph.factors())
    names.push_back(graph.batches()[factor.batch]->type_name());
  EXPECT_EQ(names, (std::vector<std::string_view>{"landmark_xy", "between_se2", "landmark_xy",
                                                  "prior_xy"}));
  EXPECT_EQ(graph.slots_of(graph.factors()[0]), (std::vector<VariableSlot>{1, 2}));
  EXPECT_EQ(graph.slots_of(graph.factors()[1]), (std::vector<VariableSlot>{1, 0}));
  EXPECT_EQ(graph.find_batch<LandmarkXy>()->size(), 2u);
  EXPECT_EQ(graph.find_batch<BetweenSe2>()->kinds()[0], FactorKind::kOdometry);
  EXPECT_EQ(graph.find_batch<BetweenSe3>(), nullptr);
}

TEST(Graph, CopiesAreDeep) {
  Graph original = random_pose_graph<Se2>({.seed = 5}).graph;
  Graph copy = original;
  copy.values().pose2[3] = Se2(100.0, 0.0, 0.0);
  copy.set_kind(copy.factors()[0], FactorKind::kLoop);
  copy.set_fixed(0, true);
  ASSERT_TRUE(copy.add_pose2(VariableId{999}, Se2()).ok());
  ASSERT_TRUE(copy.add_factor(kStep, {VariableId{0}, VariableId{999}}).ok());
  EXPECT_NE(original.values().pose2[3].x(), 100.0);
  EXPECT_EQ(original.batches()[0]->kinds()[0], FactorKind::kOdometry);
  EXPECT_FALSE(original.variables()[0].fixed);
  EXPECT_EQ(original.find(VariableId{999}), std::nullopt);
  EXPECT_EQ(copy.factor_count(), original.factor_count() + 1);
  original = copy;
  EXPECT_EQ(original.factor_count(), copy.factor_count());
  EXPECT_NE(original.batches()[0].get(), copy.batches()[0].get());
}

std::vector<FactorKind> kinds_after_classification(Graph& graph) {
  classify_factor_kinds(graph);
  std::vector<FactorKind> kinds;
  for (const FactorRef factor : graph.factors()) {
    kinds.push_back(graph.batches()[factor.batch]->kinds()[factor.index]);
  }
  return kinds;
}

void connect(Graph& graph, std::uint64_t a, std::uint64_t b, FactorKind kind = FactorKind::kOther) {
  ASSERT_TRUE(graph.add_factor(kStep, {VariableId{a}, VariableId{b}}, kind).ok());
}

constexpr FactorKind kOdometry = FactorKind::kOdometry;
constexpr FactorKind kLoop = FactorKind::kLoop;

TEST(FactorKinds, OdometryIsBetweenNeighborsAmongSortedIds) {
  Graph graph = line_of_poses({30, 10, 20, 50});  // sparse and unordered
  connect(graph, 10, 20);
  connect(graph, 30, 20);  // from newer to older
  connect(graph, 10, 30);
  connect(graph, 30, 50);
  EXPECT_EQ(kinds_after_classification(graph),
            (std::vector{kOdometry, kOdometry, kLoop, kOdometry}));
}

TEST(FactorKinds, OnlyTheFirstEdgeOfAPairIsOdometry) {
  Graph graph = line_of_poses({1, 2});
  connect(graph, 2, 1);
  connect(graph, 1, 2);
  connect(graph, 1, 2);
  EXPECT_EQ(kinds_after_classification(graph), (std::vector{kOdometry, kLoop, kLoop}));
}

TEST(FactorKinds, FactorsSentAsOdometryStaySoAndTakeTheirPair) {
  Graph graph = line_of_poses({1, 2, 3});
  connect(graph, 1, 2);
  connect(graph, 1, 2, kOdometry);
  connect(graph, 1, 3, kOdometry);  // skips a pose, as the sender says
  connect(graph, 2, 3);
  EXPECT_EQ(kinds_after_classification(graph),
            (std::vector{kLoop, kOdometry, kOdometry, kOdometry}));
}

TEST(FactorKinds, TheTopByteOfTheIdSeparatesRobots) {
  const std::uint64_t a = std::uint64_t{'a'} << 56, b = std::uint64_t{'b'} << 56;
  Graph graph = line_of_poses({a | 1, a | 2, b | 1, b | 2});
  connect(graph, a | 1, a | 2);
  connect(graph, a | 2, b | 1);  // neighbors in sorted order, but two robots
  connect(graph, b | 1, b | 2);
  EXPECT_EQ(kinds_after_classification(graph), (std::vector{kOdometry, kLoop, kOdometry}));
}

TEST(FactorKinds, LandmarksAreNoNeighborsAndTheirFactorsKeepTheirKind) {
  Graph graph = line_of_poses({1, 3});
  ASSERT_TRUE(graph.add_point2(VariableId{2}, {0.0, 0.0}).ok());
  connect(graph, 1, 3);
  const LandmarkXy sighting{{1.0, 0.0}, {}, Eigen::Matrix2d::Identity()};
  ASSERT_TRUE(graph.add_factor(sighting, {VariableId{1}, VariableId{2}}).ok());
  EXPECT_EQ(kinds_after_classification(graph), (std::vector{kOdometry, FactorKind::kOther}));
}

TEST(RandomPoseGraph, IsConsistentWithItsTruthAndItsSeed) {
  const RandomGraph<Se3> clean =
      random_pose_graph<Se3>({.seed = 8, .noise = 0.0, .start_noise = 0.0});
  for (const auto& batch : clean.graph.batches()) {
    EXPECT_LT(batch->evaluate_cost(0, batch->size(), {clean.graph.values()}).chi2, 1e-20);
  }
  EXPECT_EQ(clean.graph.factor_count(), 49u);
  const RandomGraph<Se3> again =
      random_pose_graph<Se3>({.seed = 8, .noise = 0.0, .start_noise = 0.0});
  EXPECT_EQ(clean.truth.back().translation(), again.truth.back().translation());
}

}  // namespace
}  // namespace cairn::test
