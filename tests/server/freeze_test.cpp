// SPDX-License-Identifier: BSD-3-Clause
// A frozen map stays where it is, whatever comes; who comes later finds itself in it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cairn/history/apply_record.hpp"
#include "cairn/history/order.hpp"
#include "server/reexecution.hpp"
#include "tests/server/live_service.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::SizeIs;

class Frozen : public test::LiveService {
 protected:
  PoseGraph map() const {
    const auto maps = maps_at(*journal_, {journal_->head().revision.number});
    EXPECT_TRUE(maps) << maps.error().to_string();
    return maps->front();
  }
  std::vector<Estimate> estimates(const std::string& robot, std::uint64_t epoch) const {
    std::vector<Estimate> found;
    const PoseGraph now = map();
    for (NodeIndex i = 0; i < now.nodes.size(); ++i)
      if (now.nodes[i].id.frame == OdometryFrame{robot, epoch}) found.push_back(now.estimates[i]);
    return found;
  }
  // The leader once more, in a new epoch, which meets its old one every fifth step, 0.2 m aside of
  // where that is.
  Revision return_as(std::uint64_t epoch, std::uint64_t steps) {
    Revision last;
    for (std::uint64_t i = 0; i < steps; ++i) {
      Transaction step = test::drive_step(test::kLeader, i);
      step.variables[0].node.frame.epoch = epoch;
      step.factors.resize(std::min<std::size_t>(step.factors.size(), 1));
      for (NewFactor& factor : step.factors)
        for (NodeId& node : factor.nodes) node.frame.epoch = epoch;
      if (i % 5 == 0) {
        NewFactor loop;
        loop.type = FactorType{1};
        loop.kind = FactorKind::kLoop;
        loop.nodes = {{{test::kLeader, 3}, i}, {{test::kLeader, epoch}, i}};
        loop.numbers = {0.0, 0.2, 0.0, 400.0, 0.0, 0.0, 400.0, 0.0, 900.0};
        step.factors.push_back(loop);
      }
      last = submit(step);
    }
    EXPECT_TRUE(client_->wait_solved(last, 10s));
    return last;
  }
  std::string command(const std::string& text) {
    const auto answer = client_->command(text, 10s);
    EXPECT_TRUE(answer) << answer.error().to_string();
    return answer ? *answer : "";
  }
};

TEST_F(Frozen, MapsStayAndANewEpochLocalizesAgainstThem) {
  start();
  for (const Transaction& step : test::drive(31)) submit(step);
  EXPECT_THAT(command("freeze {\"operator\":\"anna\",\"reason\":\"it is good\"}"),
              HasSubstr("31 nodes frozen, record "));
  EXPECT_EQ(map().frozen_nodes, 31u);
  const std::vector<Estimate> before = estimates(test::kLeader, 3);
  return_as(4, 21);
  EXPECT_EQ(estimates(test::kLeader, 3), before);
  const std::vector<Estimate> later = estimates(test::kLeader, 4);
  ASSERT_THAT(later, SizeIs(21));
  for (std::uint64_t i = 5; i < 16; ++i) {
    EXPECT_NEAR(later[i][0], before[i][0], 0.15);
    EXPECT_NEAR(later[i][1], before[i][1] + 0.2, 0.1);
  }
  ASSERT_TRUE(client_->command("settle", 10s));
  EXPECT_EQ(estimates(test::kLeader, 3), before);

  // Free again, both give way; frozen by undoing the thaw, they stay where they are then.
  const std::string thawed = command("thaw {\"operator\":\"anna\",\"reason\":\"\"}");
  EXPECT_THAT(thawed, HasSubstr("all nodes may move again, record "));
  ASSERT_TRUE(client_->command("settle", 10s));
  const std::vector<Estimate> moved = estimates(test::kLeader, 3);
  EXPECT_NE(moved, before);
  command("undo {\"record\":" + thawed.substr(thawed.rfind(' ') + 1) +
          ",\"operator\":\"anna\",\"reason\":\"\"}");
  EXPECT_EQ(map().frozen_nodes, 31u);
  submit(test::drive_step(test::kLeader, 31));
  ASSERT_TRUE(client_->command("settle", 10s));
  EXPECT_EQ(estimates(test::kLeader, 3).size(), 32u);
  for (std::size_t i = 0; i < moved.size(); ++i)
    EXPECT_EQ(estimates(test::kLeader, 3)[i], moved[i]);

  const auto executed = Reexecution(*journal_).run();
  ASSERT_TRUE(executed) << executed.error().to_string();
  EXPECT_EQ(executed->solves, solves().size());
  EXPECT_EQ(executed->commands, 3u);
}

// Where everything is frozen a solve has nothing to move, and is one all the same.
TEST_F(Frozen, MapsWithoutNewcomersAreSettled) {
  start();
  for (const Transaction& step : test::drive(12)) submit(step);
  const std::string freeze = "freeze {\"operator\":\"anna\",\"reason\":\"\"}";
  EXPECT_THAT(command(freeze), HasSubstr("12 nodes frozen"));
  EXPECT_THAT(command("settle"), HasSubstr("settled at "));
  const std::uint64_t head = journal_->head().revision.number;
  EXPECT_THAT(command(freeze), HasSubstr("nothing changed"));
  EXPECT_THAT(command("settle"), HasSubstr("settled at "));
  EXPECT_EQ(journal_->head().revision.number, head);
}

// As yesterday's map: a robot that was started anew finds itself in it by loops alone.
TEST_F(Frozen, OrNotANewEpochResumesTheMapByThreeLoops) {
  start();
  for (const Transaction& step : test::drive(31)) submit(step);
  std::map<std::uint64_t, std::string> map_of_epoch;
  client_->on_poses([&](const PoseUpdate& update) {
    const std::lock_guard lock(mutex_);
    for (const PoseChunk& chunk : update.chunks) map_of_epoch[chunk.frame.epoch] = chunk.map;
  });
  const auto maps_are_one = [&] {
    const std::lock_guard lock(mutex_);
    return map_of_epoch.contains(3) && map_of_epoch[3] == map_of_epoch[5];
  };
  return_as(5, 6);  // it has met its old poses twice
  EXPECT_FALSE(maps_are_one());
  return_as(6, 21);
  const std::lock_guard lock(mutex_);
  EXPECT_EQ(map_of_epoch[6], map_of_epoch.contains(3) ? map_of_epoch[3] : "robot/3");
}

TEST_F(Frozen, AFreezeIsRefusedWhereNothingIsSolved) {
  MapHead head;
  for (std::uint64_t i = 0; i < 3; ++i)
    head.apply(test::drive_step(test::kLeader, i), {1, 0, i + 1});
  const auto order = make_order({"freeze", nlohmann::ordered_json::object()}, *journal_, head);
  ASSERT_FALSE(order);
  EXPECT_EQ(order.error().code, ErrorCode::kNotUsable);
  EXPECT_THAT(order.error().message, HasSubstr("run cairn settle first"));
  const auto nothing = make_order({"thaw", nlohmann::ordered_json::object()}, *journal_, head);
  ASSERT_TRUE(nothing);
  EXPECT_TRUE(nothing->changes_nothing());
}

// A live solve that would take too much work is left to a solve that has no limit, at once.
TEST_F(Frozen, LiveSolvesHaveALimitThatIsCounted) {
  start({.solve_work = 0});
  for (const Transaction& step : test::drive(12)) submit(step);
  ASSERT_TRUE(client_->wait_solved(submit(test::drive_step(test::kLeader, 12)), 10s));
  EXPECT_FALSE(events("solve_deferred").empty());
  ASSERT_FALSE(solves().empty());
  for (const SolveRecord& solve : solves())
    EXPECT_EQ(SolveSettings::parse(solve.settings).known(), SolveMethod{SolveKind::kSettled});
}

TEST_F(Frozen, AsManyLoopsMergeAsIsConfigured) {
  start({.loops_that_merge = 1});
  for (const Transaction& step : test::drive(31)) submit(step);
  return_as(4, 6);  // it has met its old poses once before the last step, which ends in a loop
  const PoseGraph now = map();
  EXPECT_EQ(now.loops_that_merge, 1u);
  EXPECT_EQ(now.factors[now.factors.size() - 1].kind, FactorKind::kLoop);
  EXPECT_EQ(now.factors[now.factors.size() - 1].state, FactorState::kCommitted);
  const auto executed = Reexecution(*journal_).run();
  ASSERT_TRUE(executed) << executed.error().to_string();
  EXPECT_EQ(executed->solves, solves().size());
}

}  // namespace
}  // namespace cairn
