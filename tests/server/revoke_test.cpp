// SPDX-License-Identifier: BSD-3-Clause
// revoke: everything that a source has sent since then; trust and doubt: an operator's word on a
// loop closure.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/reexecution.hpp"
#include "tests/server/ordered_map.hpp"

namespace cairn {
namespace {

using test::Json;
using test::OrderedMap;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kSecond_ns = 1'000'000'000;

// A leader's drive, record 2 k + 1, and a follower's, record 2 k + 2, tied to it now and then.
void take_two(OrderedMap& map, std::uint64_t count, std::uint64_t of_follower) {
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto time_ns = static_cast<std::int64_t>(i) * kSecond_ns;
    map.take(test::drive_step("robot", i), "laser", time_ns);
    if (i < of_follower) map.take(test::drive_step("other", i), "camera", time_ns);
  }
}

TEST(Revoke, LeavesTheMapAsIfNothingHadComeOfTheSourceSince) {
  OrderedMap map, until, kept;
  take_two(map, 40, 40);
  take_two(kept, 40, 40);
  take_two(until, 40, 15);
  // Record 31 is the leader's 16th, and 32 the follower's.
  const std::uint64_t revoked = map.give("revoke", {{"source", "camera"}, {"since", "31"}});
  EXPECT_NE(map.settled(), kept.settled());
  EXPECT_EQ(map.settled(), until.settled());
  EXPECT_EQ(map.settled_after_restart(), until.settled());
  const auto again = map.ask("revoke", {{"source", "camera"}, {"since", "32"}});
  ASSERT_TRUE(again) << again.error().to_string();
  EXPECT_TRUE(again->edits.empty()) << "they are revoked already";
  const std::uint64_t undone = map.undo(revoked);
  EXPECT_EQ(map.settled(), kept.settled());
  EXPECT_EQ(map.settled_after_restart(), kept.settled());
  map.undo(undone);
  EXPECT_EQ(map.settled(), until.settled());
}

TEST(Revoke, TakesTimesAsTheLogPrintsThem) {
  OrderedMap map;
  take_two(map, 40, 40);
  const auto since = [&](const std::string& time) {
    return map.ask("revoke", {{"source", "camera"}, {"since", time}});
  };
  const auto by_number = since("32");
  ASSERT_TRUE(by_number) << by_number.error().to_string();
  for (const char* time :
       {"1970-01-01T00:00:15.000Z", "1970-01-01T00:00:15Z", "1970-01-01T00:00:14.000000001Z"}) {
    const auto order = since(time);
    ASSERT_TRUE(order) << order.error().to_string();
    EXPECT_EQ(order->edits.size(), by_number->edits.size()) << time;
  }
  EXPECT_EQ(since("1970-01-01T00:00:14.000Z")->edits.size(), by_number->edits.size() + 2);
  for (const char* time :
       {"", "yesterday", "-3", "12:0", "1970-01-01", "1970-01-01T00:00:15", "1970-02-30T00:00:00Z",
        "1970-01-01T00:00:15.5", "9999-01-01T00:00:00Z", "1970-01-01T00:00:15Z "}) {
    const auto order = since(time);
    ASSERT_FALSE(order) << time;
    EXPECT_EQ(order.error().code, ErrorCode::kUsage);
    EXPECT_THAT(order.error().message, HasSubstr("is no time; expected a record's number"));
  }
  EXPECT_EQ(since("81").error().message,
            "nothing of source 'camera' since 81 is in the map; its last record is 80");
  EXPECT_EQ(map.ask("revoke", {{"source", "lidar"}, {"since", "1"}}).error().message,
            "nothing of source 'lidar' since 1 is in the map; cairn status lists sources");
}

TEST(Revoke, OfWhatOtherSourcesHaveBuiltOnTakesThemAlongOrIsRefused) {
  OrderedMap map, until;
  take_two(map, 25, 25);
  for (std::uint64_t i = 0; i < 15; ++i) {
    until.take(test::drive_step("robot", i), "laser");
    Transaction follower = test::drive_step("other", i);
    until.take(follower, "camera");
  }
  for (std::uint64_t i = 15; i < 20; ++i) until.take(test::drive_step("other", i), "camera");
  // From record 31 on the leader's; at 20 the follower saw it, and goes on from there.
  const auto refused = map.ask("revoke", {{"source", "laser"}, {"since", "31"}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kNotUsable);
  EXPECT_EQ(refused.error().message,
            "later records use variables that source 'laser' added, and would have been refused "
            "without it: 42, 44, 46, 48, 50; --cascade undoes them, too");
  map.give("revoke", {{"source", "laser"}, {"since", "31"}, {"cascade", true}});
  EXPECT_EQ(map.settled(), until.settled());
  EXPECT_EQ(map.settled_after_restart(), until.settled());
}

TEST(Revoke, RefusesWhereTransactionsHaveSwitchedFactors) {
  OrderedMap map;
  map.take_all(test::drive(10));
  Transaction edits;
  edits.edits.push_back({{{"laser", 7, 9}, 0}, FactorChange::kDisable});
  map.take(edits, "janitor");
  for (const char* source : {"laser", "janitor"}) {
    const auto refused = map.ask("revoke", {{"source", source}, {"since", "2"}, {"cascade", true}});
    ASSERT_FALSE(refused) << source;
    EXPECT_THAT(refused.error().message, HasSubstr("record 11 switches factors itself"));
  }
}

// 30 steps and a false loop, which is record 31.
class Trust : public testing::Test {
 protected:
  Trust() {
    map_.take_all(test::drive(30));
    map_.take(test::false_loop(2, 25));
    map_.solve();
  }
  [[nodiscard]] FactorState state() const { return map_.state(map_.graph().factors.size() - 1); }
  [[nodiscard]] double x() const { return map_.graph().estimates[25][0]; }
  [[nodiscard]] std::size_t solved_again() const {
    const auto executed = Reexecution(map_.journal()).run();
    EXPECT_TRUE(executed) << executed.error().to_string();
    return executed ? executed->solves : 0;
  }

  OrderedMap map_;
};

TEST_F(Trust, HasALoopInTheMapThatTheGateKeepsOut) {
  const std::vector<double> before = map_.settled();
  ASSERT_EQ(state(), FactorState::kQuarantined);
  const std::uint64_t trusted = map_.give("edge trust", {{"factors", {"31:0"}}});
  EXPECT_EQ(state(), FactorState::kTrusted);
  EXPECT_TRUE(map_.ask("edge trust", {{"factors", {"31"}}})->edits.empty());
  for (const SolveKind kind : {SolveKind::kLive, SolveKind::kSettled}) {
    map_.solve(kind);
    EXPECT_EQ(state(), FactorState::kTrusted);
    EXPECT_GT(std::abs(x() - 25.0), 1.0) << "the map gives way";
  }
  const std::vector<double> forced = map_.settled();
  EXPECT_EQ(map_.settled_after_restart(), forced);
  const std::uint64_t undone = map_.undo(trusted);
  EXPECT_EQ(state(), FactorState::kPending);
  EXPECT_EQ(map_.settled(), before);
  map_.solve(SolveKind::kLive);
  EXPECT_EQ(state(), FactorState::kQuarantined);
  EXPECT_NEAR(x(), 25.0, 1.0);
  map_.undo(undone);
  EXPECT_EQ(map_.settled(), forced);
  map_.give("edge doubt", {{"factors", {"31:0"}}});
  EXPECT_EQ(map_.settled(), before);
  map_.solve();
  EXPECT_EQ(map_.settled_after_restart(), before);
  EXPECT_EQ(solved_again(), 5u);
}

TEST_F(Trust, SurvivesBeingSwitchedOffAndOnByUndo) {
  map_.give("edge disable", {{"factors", {"31:0"}}});
  const std::uint64_t trusted = map_.give("edge trust", {{"factors", {"31:0"}}});
  EXPECT_EQ(state(), FactorState::kTrusted);
  const std::uint64_t disabled = map_.give("edge disable", {{"factors", {"31:0"}}});
  EXPECT_EQ(state(), FactorState::kDisabled);
  map_.undo(disabled);
  EXPECT_EQ(state(), FactorState::kTrusted);
  const std::uint64_t gone = map_.undo(31);
  EXPECT_EQ(state(), FactorState::kDisabled);
  map_.undo(gone);
  EXPECT_EQ(state(), FactorState::kTrusted);
  map_.undo(trusted);
  EXPECT_EQ(state(), FactorState::kDisabled) << "as it was before it was trusted";
  EXPECT_EQ(solved_again(), 1u);
}

TEST_F(Trust, IsForLoopClosuresOnly) {
  const auto refused = map_.ask("edge trust", {{"factors", {"30"}}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message,
            "factor 30:0 is no loop closure between poses, so the gate decides nothing about it; "
            "name one (cairn edge show)");
  map_.give("edge remove", {{"factors", {"31:0"}}});
  EXPECT_THAT(map_.ask("edge trust", {{"factors", {"31:0"}}}).error().message,
              HasSubstr("what was removed stays removed"));
}

// Two robots whose maps one loop ties: not enough for the gate.
TEST(TrustBetweenRobots, MergesTheirMaps) {
  OrderedMap map;
  map.take_all(test::drive(10));
  for (std::uint64_t i = 0; i < 8; ++i) map.take(test::drive_step("other", i), "camera");
  map.solve();
  std::size_t between = 0;
  for (std::size_t f = 0; f < map.graph().factors.size(); ++f)
    if (map.state(f) == FactorState::kPending) between = f;
  ASSERT_GT(between, 0u);
  const std::string name = std::to_string(map.graph().factors[between].record) + ":0";
  map.give("edge trust", {{"factors", {name}}});
  map.solve();
  EXPECT_EQ(map.state(between), FactorState::kTrusted);
  EXPECT_NEAR(map.graph().estimates[10][1], map.graph().estimates[0][1], 0.5);
}

}  // namespace
}  // namespace cairn
