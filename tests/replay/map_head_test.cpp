// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/replay/map_head.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "cairn/factors/factor_codec.hpp"

namespace cairn {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

NodeId node(std::uint64_t index, const char* robot = "r") { return {{robot, 1}, index}; }

// Pose 1 is known; the transaction adds pose 2 and ties it to pose 1.
MapHead known_pose() {
  MapHead head;
  Transaction first;
  first.key = {"s", 1, 1};
  first.variables.push_back({node(1), VariableType::kPose2, {0.0, 0.0, 0.0}, 0, {}});
  EXPECT_FALSE(head.check(first));
  head.apply(first, {1, 0, 1});
  return head;
}

Transaction good() {
  Transaction step;
  step.key = {"s", 1, 2};
  step.variables.push_back({node(2), VariableType::kPose2, {9.0, 9.0, 0.0}, 0, {}});
  NewFactor odometry;
  odometry.type = FactorType{1};
  odometry.kind = FactorKind::kOdometry;
  odometry.nodes = {node(1), node(2)};
  odometry.numbers = {1.0, 2.0, 0.5, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0};
  step.factors.push_back(odometry);
  return step;
}

TEST(MapHead, PlacesANewPoseWhereOdometryLeads) {
  MapHead head = known_pose();
  ASSERT_FALSE(head.check(good()));
  head.apply(good(), {1, 0, 2});
  EXPECT_EQ(head.graph().estimates[1], (Estimate{1.0, 2.0, 0.5}));
  EXPECT_EQ(head.graph().nodes[1].start, (std::vector{9.0, 9.0, 0.0}));
  EXPECT_EQ(head.graph().graph_revision.number, 2U);
}

TEST(MapHead, ComposesPosesThatCameDuringASolveOntoItsResult) {
  MapHead head = known_pose();
  head.apply(good(), {1, 0, 2});
  Transaction third = good();
  third.key.sequence = 3;
  third.variables[0].node = node(3);
  third.factors[0].nodes = {node(2), node(3)};
  head.apply(third, {1, 0, 3});
  const Estimate solved{5.0, 6.0, 0.0};
  // The solve has seen record 1 only.
  head.apply_estimates(std::vector{std::pair(NodeIndex{0}, solved)}, {1, 0, 1}, {1, 0, 4});
  EXPECT_EQ(head.graph().estimates[0], solved);
  EXPECT_EQ(head.graph().estimates[1], (Estimate{6.0, 8.0, 0.5}));
  const Estimate third_pose = head.graph().estimates[2];
  EXPECT_NEAR(third_pose[0], 6.0 + std::cos(0.5) - 2.0 * std::sin(0.5), 1e-12);
  EXPECT_NEAR(third_pose[1], 8.0 + std::sin(0.5) + 2.0 * std::cos(0.5), 1e-12);
  // One that has seen all of them says where each is.
  head.apply_estimates(std::vector{std::pair(NodeIndex{0}, Estimate{})}, {1, 0, 3}, {1, 0, 5});
  EXPECT_EQ(head.graph().estimates[2], third_pose);
}

TEST(MapHead, RefusesWhatBreaksARuleAndSaysWhich) {
  struct Case {
    std::function<void(Transaction&)> spoil;
    RefusalCode code;
    std::string reason;
  };
  const Case cases[] = {
      {[](Transaction& t) { t.key.source.clear(); }, RefusalCode::kMalformed,
       "the source's name has 0 bytes; expected 1 to 64"},
      {[](Transaction& t) { t.variables[0].node.frame.robot = std::string(65, 'r'); },
       RefusalCode::kMalformed, "the robot's name has 65 bytes; expected 1 to 64"},
      {[](Transaction& t) { t.variables[0].start = {1.0}; }, RefusalCode::kMalformed,
       "start of r/1/2: SE(2) pose expects 3 numbers, found 1"},
      {[](Transaction& t) { t.variables[0].start[1] = kNan; }, RefusalCode::kNotFinite,
       "start of r/1/2: SE(2) pose holds a number that is not finite"},
      {[](Transaction& t) { t.variables[0].node = node(1); }, RefusalCode::kConflict,
       "the node r/1/1 exists already"},
      {[](Transaction& t) { t.variables.push_back(t.variables[0]); }, RefusalCode::kConflict,
       "the node r/1/2 exists already"},
      {[](Transaction& t) { t.factors[0].type = FactorType{77}; }, RefusalCode::kMalformed,
       "factor 0: factor type 77 is not known; known are 1 to 22"},
      {[](Transaction& t) { t.factors[0].nodes.pop_back(); }, RefusalCode::kMalformed,
       "factor 0: between_se2 expects 2 nodes, found 1"},
      {[](Transaction& t) { t.factors[0].numbers.push_back(0.0); }, RefusalCode::kMalformed,
       "factor 0: between_se2 expects 9 numbers, found 10"},
      {[](Transaction& t) { t.factors[0].numbers[0] = kNan; }, RefusalCode::kNotFinite,
       "factor 0: between_se2 holds a number that is not finite"},
      {[](Transaction& t) { t.factors[0].numbers[3] = -1.0; }, RefusalCode::kInformation,
       "factor 0: the information of between_se2 is not positive semidefinite"},
      {[](Transaction& t) { t.factors[0].nodes[0] = node(2); }, RefusalCode::kMalformed,
       "factor 0: between_se2 ties r/1/2 to itself"},
      {[](Transaction& t) { t.factors[0].nodes[0] = node(3); }, RefusalCode::kUnknownVariable,
       "factor 0: the node r/1/3 is not known"},
      {[](Transaction& t) {
         t.factors[0].type = FactorType{6};
         t.factors[0].numbers.assign(8, 1.0);
         t.factors[0].numbers[6] = 0.0;
       },
       RefusalCode::kMalformed,
       "factor 0: landmark_xy expects a 2-D point as node 1, found SE(2) pose r/1/2"},
      {[](Transaction& t) {
         t.edits.push_back({{{"s", 1, 1}, 0}, FactorChange::kDisable});
       },
       RefusalCode::kUnknownVariable, "factor 0 of s/1 is not known"},
  };
  const MapHead head = known_pose();
  for (const Case& c : cases) {
    Transaction spoiled = good();
    c.spoil(spoiled);
    const auto refusal = head.check(spoiled);
    ASSERT_TRUE(refusal) << c.reason;
    EXPECT_EQ(refusal->reason, c.reason);
    EXPECT_EQ(refusal->code, c.code) << c.reason;
    EXPECT_FALSE(refusal->awaited) << c.reason;
  }
  EXPECT_FALSE(head.check(good()));
}

TEST(MapHead, HasOneDatum) {
  const auto with_fix = [](std::uint64_t sequence, std::optional<Geodetic> datum) {
    Transaction transaction;
    transaction.key = {"s", 1, sequence};
    NewFactor fix;
    fix.type = FactorType{15};
    fix.nodes = {node(1)};
    fix.numbers = {0.0, 0.0, 5.0, 6.0, 1.0, 0.0, 1.0};
    if (datum) set_datum(fix, *datum);
    transaction.factors = {fix};
    return transaction;
  };
  MapHead head = known_pose();
  const Geodetic here{47.0, 8.5, 400.0}, elsewhere{48.0, 8.5, 400.0};
  ASSERT_FALSE(head.check(with_fix(2, {})));
  EXPECT_FALSE(head.graph().datum);
  Transaction both = with_fix(2, here);
  both.factors.push_back(with_fix(2, elsewhere).factors[0]);
  EXPECT_EQ(head.check(both)->code, RefusalCode::kDatum) << "against itself";
  ASSERT_FALSE(head.check(with_fix(2, here)));
  head.apply(with_fix(2, here), {1, 0, 2});
  EXPECT_EQ(head.graph().datum, here);
  EXPECT_FALSE(head.check(with_fix(3, here)));
  EXPECT_FALSE(head.check(with_fix(3, {}))) << "in the map frame, wherever that is";
  const auto refusal = head.check(with_fix(3, elsewhere));
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->code, RefusalCode::kDatum);
  EXPECT_EQ(refusal->reason,
            "factor 0: its datum is 48 8.5 400, that of this map is 47 8.5 400: send positions in "
            "the frame at that datum");
}

TEST(MapHead, AwaitsNodesThatAnotherSourceMayAdd) {
  const MapHead head = known_pose();
  Transaction meeting = good();
  meeting.factors[0].nodes[0] = node(5, "other");
  const auto refusal = head.check(meeting);
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->code, RefusalCode::kUnknownVariable);
  EXPECT_EQ(refusal->awaited, node(5, "other"));
}

TEST(MapHead, GivesAFactorsPayloadsToItsPosesFromTheLastOneBackwards) {
  const ContentHash a{1}, b{2}, c{3};
  MapHead head = known_pose();
  Transaction step = good();
  step.factors[0].payloads = {b};
  head.apply(step, {1, 0, 2});
  const PoseGraph before = head.graph();
  EXPECT_TRUE(before.nodes[0].payloads.empty());
  EXPECT_EQ(before.nodes[1].payloads, std::vector{b});

  Transaction loop = good();
  loop.key.sequence = 3;
  loop.variables.clear();
  loop.factors[0].payloads = {c, a, b};  // more than there are poses: the first is nobody's
  head.apply(loop, {1, 0, 3});
  EXPECT_EQ(head.graph().nodes[0].payloads, std::vector{a});
  EXPECT_EQ(head.graph().nodes[1].payloads, std::vector{b}) << "it had this one already";
  loop.key.sequence = 4;
  loop.factors[0].payloads = {a};
  head.apply(loop, {1, 0, 4});
  EXPECT_EQ(head.graph().nodes[1].payloads, (std::vector{a, b})) << "in order of their hashes";
  EXPECT_TRUE(before.nodes[0].payloads.empty()) << "a snapshot stays as it is";
}

TEST(MapHead, GivesSnapshotsThatDoNotChange) {
  MapHead head = known_pose();
  const PoseGraph snapshot = head.graph();
  head.apply(good(), {1, 0, 2});
  head.apply_estimates(std::vector<std::pair<NodeIndex, Estimate>>{{0, Estimate{7.0}}}, {1, 0, 2},
                       {1, 0, 3});
  EXPECT_EQ(snapshot.nodes.size(), 1U);
  EXPECT_EQ(snapshot.estimates[0], Estimate{});
  EXPECT_EQ(head.graph().estimates[0], Estimate{7.0});
  EXPECT_EQ(head.graph().solved_revision.number, 2U);
}

}  // namespace
}  // namespace cairn
