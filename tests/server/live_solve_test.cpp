// SPDX-License-Identifier: BSD-3-Clause
// Solving while serving: what closes a loop is solved at once, and nobody waits for it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <mutex>
#include <thread>

#include "server/reexecution.hpp"
#include "tests/server/live_service.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;

class LiveSolve : public test::LiveService {};

TEST_F(LiveSolve, AnEmptyMapNamesItsStore) {
  start();
  const auto told = client_->wait_for(journal_->head().revision, 10s);
  EXPECT_TRUE(told) << told.error().to_string();
}

TEST_F(LiveSolve, FollowsALoopAtOnceAndOdometryNever) {
  start();
  Revision last;
  for (const Transaction& step : test::drive(7)) last = submit(step);  // without a loop
  ASSERT_TRUE(client_->wait_for(last, 10s));
  EXPECT_TRUE(solves().empty());
  const Revision loop = submit(test::drive_step(test::kLeader, 7));
  ASSERT_TRUE(client_->wait_solved(loop, 10s));
  const auto kept = solves();
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_EQ(kept[0].base, loop.number);
  EXPECT_EQ(SolveSettings::parse(kept[0].settings).known(), SolveMethod{SolveKind::kLive});

  // What clients see is the optimum of this prefix.
  MapHead head;
  std::uint64_t number = 0;
  for (const Transaction& step : test::drive(8)) head.apply(step, {1, 0, ++number});
  for (const auto& [node, estimate] : changed_estimates(head.graph(), settle(head.graph())))
    EXPECT_NEAR(x(head.graph().nodes[node].id.index), estimate[0], 2 * kLiveTolerance);
}

TEST_F(LiveSolve, KeepsNobodyWaiting) {
  std::atomic<int> solving{0};
  std::atomic<bool> go_on{false};
  start({.on_point = [&](ServicePoint point) {
    if (point != ServicePoint::kSolving) return;
    ++solving;
    while (!go_on) std::this_thread::sleep_for(1ms);
  }});
  const auto steps = test::drive(30);
  Revision last;
  for (std::size_t i = 0; i < 8; ++i) last = submit(steps[i]);
  while (solving == 0) std::this_thread::sleep_for(1ms);
  for (std::size_t i = 8; i < 30; ++i) last = submit(steps[i]);  // receipts come all the same
  ASSERT_TRUE(client_->wait_for(last, 10s));                     // and poses
  EXPECT_EQ(solving, 1);
  EXPECT_NEAR(x(29), 29.0, 2.0);
  EXPECT_TRUE(solves().empty());
  go_on = true;
  ASSERT_TRUE(client_->wait_solved(last, 10s));  // by the next solve, which follows at once
  const auto kept = solves();
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_EQ(kept[0].base, 8u);
  EXPECT_EQ(kept[1].base, kept[0].base + 24) << "a verdict and a solve came in between";
}

TEST_F(LiveSolve, FollowsWhatElseTheSolversThreadDoes) {
  std::atomic<bool> measuring{false}, go_on{false};
  ServiceOptions options;
  options.maps.enabled = false;  // nor does that wake the deciding thread
  options.on_point = [&](ServicePoint point) {
    if (point != ServicePoint::kMeasuringTrust) return;
    measuring = true;
    while (!go_on) std::this_thread::sleep_for(1ms);
  };
  start(options);
  for (const Transaction& step : test::drive(8)) submit(step);
  while (!measuring) std::this_thread::sleep_for(1ms);
  submit(test::drive_step(test::kLeader, 8));
  client_.reset();  // and nobody says anything more
  std::this_thread::sleep_for(50ms);
  go_on = true;
  for (int i = 0; i < 10'000 && solves().size() < 2; ++i) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(solves().size(), 2u);
}

// A robot that believes to stand still while it drives.
TEST_F(LiveSolve, TellsOfAJumpBeforeItHappens) {
  std::vector<std::string> order;
  std::mutex order_mutex;
  const auto note = [&](std::string what) {
    const std::lock_guard lock(order_mutex);
    order.push_back(std::move(what));
  };
  start({.jump_cm = 50, .on_event = [&](const Event& event) {
           if (event.kind == "jump") note(event.text);
         }});
  client_->on_corrections([&](const Correction& correction) {
    if (correction.jump_m > 0.5) note("jump");
  });
  auto steps = test::drive(8);
  for (Transaction& step : steps) step.variables[0].odometry = step.variables[0].start;
  for (std::size_t i = 1; i < 8; ++i) steps[i].factors[0].numbers[0] = 0.0;
  Revision last;
  for (const Transaction& step : steps) last = submit(step);
  ASSERT_TRUE(client_->wait_solved(last, 10s));
  ASSERT_TRUE(client_->command("settle", 10s));
  const std::lock_guard lock(order_mutex);
  ASSERT_GE(order.size(), 2u);
  EXPECT_THAT(order[0], testing::StartsWith("the map moves under robot, whose newest keyframe "
                                            "goes by "));
  EXPECT_EQ(order[1], "jump");
}

TEST_F(LiveSolve, IsExecutedAgainBitForBitAndSettledWhenAsked) {
  start();
  const auto steps = test::drive(40);
  Revision last;
  for (const Transaction& step : steps) last = submit(step);
  ASSERT_TRUE(client_->wait_solved(last, 10s));
  const auto live = solves().size();
  EXPECT_GT(live, 0u);
  ASSERT_TRUE(client_->command("settle", 10s));
  EXPECT_EQ(test::estimates(*journal_), test::settled_estimates(steps));
  client_.reset();
  service_.reset();
  Reexecution again(*journal_);
  const auto executed = again.run({});
  ASSERT_TRUE(executed) << executed.error().to_string();
  EXPECT_GE(executed->solves, live);
  EXPECT_EQ(executed->solves_skipped, 0u);
}

}  // namespace
}  // namespace cairn
