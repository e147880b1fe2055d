// SPDX-License-Identifier: BSD-3-Clause
// The gate behind the daemon's solves: false loops stay out, robots share a map when enough loops
// say so, and everything is executed again alike.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cairn/history/apply_record.hpp"
#include "server/reexecution.hpp"
#include "tests/server/live_service.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class Gated : public test::LiveService {
 protected:
  std::map<FactorState, int> count_states() const {
    std::map<FactorState, int> count;
    const auto maps = maps_at(*journal_, {journal_->head().revision.number});
    EXPECT_TRUE(maps) << maps.error().to_string();
    for (std::size_t f = 0; maps && f < maps->front().factors.size(); ++f)
      ++count[maps->front().factors[f].state];
    return count;
  }
  void expect_executed_again() {
    const auto executed = Reexecution(*journal_).run();
    ASSERT_TRUE(executed) << executed.error().to_string();
    EXPECT_EQ(executed->solves, solves().size());
  }
};

TEST_F(Gated, KeepsAFalseLoopOutAndSaysWhy) {
  start();
  for (const Transaction& step : test::drive(30)) submit(step);
  const Revision wrong = submit(test::false_loop(2, 25));
  ASSERT_TRUE(client_->wait_solved(wrong, 10s));
  EXPECT_NEAR(x(25), 25.0, 1.0);
  const auto told = events("loop_quarantined");
  ASSERT_THAT(told, SizeIs(1));
  EXPECT_EQ(told[0].factor->transaction.sequence, 31u);
  EXPECT_EQ(told[0].severity, Severity::kWarning);
  EXPECT_THAT(told[0].text, HasSubstr("the loop closure robot/3/2 - robot/3/25 of record "));
  EXPECT_THAT(told[0].text, HasSubstr("is quarantined, does not fit the map: "));
  EXPECT_THAT(told[0].text, HasSubstr("; contradicted by record "));
  EXPECT_EQ(count_states()[FactorState::kQuarantined], 1);
  // What comes later is solved without it, and finds it as false as ever.
  ASSERT_TRUE(client_->wait_solved(submit(test::drive(31).back()), 10s));
  ASSERT_TRUE(client_->command("settle", 10s));
  EXPECT_NEAR(x(25), 25.0, 1.0);
  EXPECT_THAT(events("loop_quarantined"), SizeIs(1));
  EXPECT_EQ(count_states(), (std::map<FactorState, int>{{FactorState::kCommitted, 54},
                                                        {FactorState::kQuarantined, 1}}));
  expect_executed_again();
}

TEST_F(Gated, FindsOutAfterwardsThatWhatCameFirstWasFalse) {
  start();
  auto steps = test::drive(30);
  for (Transaction& step : steps)
    step.factors.resize(std::min<std::size_t>(step.factors.size(), 1));
  for (const Transaction& step : steps) submit(step);
  // Odometry alone could drift so far.
  Transaction lonely = test::false_loop(0, 29);
  lonely.factors[0].numbers[0] = 26.0;
  ASSERT_TRUE(client_->wait_solved(submit(lonely), 10s));
  EXPECT_EQ(count_states()[FactorState::kQuarantined], 0);
  EXPECT_THAT(events("loop_quarantined"), IsEmpty());
  // Three others, which agree with each other, say that it did not.
  Revision last;
  for (const std::uint64_t i : {0, 1, 2, 3, 4}) {
    Transaction loop = test::false_loop(i, i + 25);
    loop.factors[0].numbers = {25.0, 0.0, 0.0, 1e6, 0.0, 0.0, 1e6, 0.0, 1e6};
    last = submit(loop);
  }
  lonely = test::false_loop(0, 29);
  lonely.factors[0].numbers = {29.0, 0.0, 0.0, 1e6, 0.0, 0.0, 1e6, 0.0, 1e6};
  last = submit(lonely);
  ASSERT_TRUE(client_->wait_solved(last, 10s));
  ASSERT_TRUE(client_->command("settle", 10s));
  const auto told = events("loop_quarantined");
  ASSERT_THAT(told, SizeIs(1));
  EXPECT_EQ(told[0].factor->transaction.sequence, 31u);
  const std::uint64_t epoch = told[0].factor->transaction.epoch;
  // And when these are taken back, it is in again.
  for (const std::uint64_t sequence : {32, 33, 34, 35, 36, 37}) {
    Transaction edit;
    edit.edits.push_back({{{"test", epoch, sequence}, 0}, FactorChange::kDisable});
    last = submit(edit);
  }
  ASSERT_TRUE(client_->wait_solved(last, 10s));
  ASSERT_TRUE(client_->command("settle", 10s));
  EXPECT_THAT(events("loop_committed"), SizeIs(1));
  EXPECT_EQ(count_states()[FactorState::kQuarantined], 0);
  expect_executed_again();
}

TEST_F(Gated, LetsTwoRobotsShareAMapFromTheThirdLoopOn) {
  start();
  for (const Transaction& step : test::drive(31)) submit(step);
  Client other = *Client::connect(
      {.source = "other", .robot = "other", .spool = folder_.path() / "other"},
      [this](Link::Identity identity) { return network_.make_link(std::move(identity)); });
  Revision last;
  const auto drive_to = [&](std::uint64_t first, std::uint64_t end) {
    for (std::uint64_t i = first; i < end; ++i) {
      const Result<Receipt> receipt = other.submit(test::drive_step("other", i), 10s);
      ASSERT_TRUE(receipt) << receipt.error().to_string();
      ASSERT_FALSE(receipt->refusal) << receipt->reason;
      last = receipt->revision;
    }
    ASSERT_TRUE(client_->wait_solved(last, 10s));
  };
  drive_to(0, 18);  // they meet at 0 and at 10
  EXPECT_NE(map_of("other"), map_of("robot"));
  EXPECT_EQ(count_states()[FactorState::kPending], 2);
  ASSERT_THAT(events("loop_pending"), SizeIs(2));
  EXPECT_THAT(events("loop_pending").back().text,
              HasSubstr("is pending, too few loops tie these maps together: 2 (limit 3)"));
  drive_to(18, 28);  // and at 20
  EXPECT_EQ(map_of("other"), map_of("robot"));
  EXPECT_EQ(count_states()[FactorState::kPending], 0);
  EXPECT_THAT(events("loop_committed"), SizeIs(2));
  // The merge is undone: two are not enough again.
  Transaction edit;
  edit.edits.push_back(
      {{events("loop_pending").back().factor->transaction, 2}, FactorChange::kDisable});
  ASSERT_TRUE(client_->wait_solved(submit(edit), 10s));
  EXPECT_NE(map_of("other"), map_of("robot"));
  EXPECT_EQ(count_states()[FactorState::kPending], 2);
  expect_executed_again();
}

// A journal of a daemon that had no gate means what it meant.
TEST(Ungated, JournalsHaveAllLoopsInTheirEstimates) {
  const test::TemporaryFolder folder;
  const auto journal = *Journal::open(folder.file("data"));
  MapHead head;
  auto steps = test::drive(30);
  steps.push_back(test::false_loop(2, 25));
  for (std::size_t i = 0; i < steps.size(); ++i) {
    steps[i].key = {"test", 1, i + 1};
    const RecordBody body = TransactionRecord{steps[i], content_hash(encode(steps[i])), 0};
    head.apply(steps[i], *journal->append({&body, 1}));
  }
  const Revision base = head.graph().graph_revision;
  Revision next = base;
  ++next.number;
  const MapSolution solution = solve_as({SolveKind::kUngated}, head.graph());
  const auto records = apply_solution(head, base, solution, next, {SolveKind::kUngated});
  EXPECT_THAT(records, SizeIs(1));
  ASSERT_TRUE(journal->append(records));
  const auto maps = maps_at(*journal, {next.number});
  ASSERT_TRUE(maps) << maps.error().to_string();
  for (std::size_t f = 0; f < maps->front().factors.size(); ++f)
    EXPECT_EQ(maps->front().factors[f].state, FactorState::kCommitted) << f;
  EXPECT_GT(std::abs(maps->front().estimates[25][0] - 25.0), 1.0) << "false as it is";
  const auto executed = Reexecution(*journal).run();
  ASSERT_TRUE(executed) << executed.error().to_string();
  EXPECT_EQ(executed->solves, 1u);
}

}  // namespace
}  // namespace cairn
