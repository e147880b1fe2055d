// SPDX-License-Identifier: BSD-3-Clause
#include "server/sequencer.hpp"

#include <gtest/gtest.h>

namespace cairn {
namespace {

NodeId node(const std::string& robot, std::uint64_t index) { return {{robot, 1}, index}; }

// Pose `sequence` of the source's own robot, tied to the one before, and to `meeting` if given.
Transaction step(const std::string& source, std::uint64_t sequence,
                 std::optional<NodeId> meeting = {}, std::uint64_t epoch = 7) {
  Transaction transaction;
  transaction.key = {source, epoch, sequence};
  transaction.variables.push_back(
      {node(source, sequence), VariableType::kPose2, {0.0, 0.0, 0.0}, 0, {}});
  const auto tie = [&](const NodeId& other) {
    NewFactor factor;
    factor.type = FactorType{1};
    factor.nodes = {other, node(source, sequence)};
    factor.numbers = {1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0};
    transaction.factors.push_back(factor);
  };
  if (sequence > 1) tie(node(source, sequence - 1));
  if (meeting) tie(*meeting);
  return transaction;
}

class SequencerTest : public ::testing::Test {
 protected:
  Sequencer::Outcome take(const Transaction& transaction, std::int64_t now_ns = 0) {
    return take(make_arrival(transaction), now_ns);
  }
  Sequencer::Outcome take(Arrival arrival, std::int64_t now_ns = 0) {
    Sequencer::Outcome outcome;
    sequencer_.take(std::move(arrival), {now_ns, head_, next(), outcome});
    number_ += outcome.decisions.size();
    return outcome;
  }
  [[nodiscard]] Revision next() const { return {1, 0, number_ + 1}; }

  MapHead head_;
  Sequencer sequencer_{{.held = 16, .patience_ns = 100, .kept_decisions = 3, .never_accepted = 2}};
  std::uint64_t number_ = 0;
};

TEST_F(SequencerTest, DecidesASourceInTheOrderOfItsSequences) {
  EXPECT_TRUE(take(step("a", 2)).decisions.empty());
  const auto outcome = take(step("a", 1));
  ASSERT_EQ(outcome.decisions.size(), 2U);
  EXPECT_EQ(outcome.decisions[0].transaction.key.sequence, 1U);
  EXPECT_EQ(outcome.decisions[1].transaction.key.sequence, 2U);
  EXPECT_EQ(head_.graph().graph_revision.number, 2U);
}

TEST_F(SequencerTest, AnswersARepetitionWithTheFirstReceipt) {
  take(step("a", 1));
  const auto again = take(step("a", 1));
  EXPECT_TRUE(again.decisions.empty());
  ASSERT_EQ(again.answers.size(), 1U);
  EXPECT_FALSE(again.answers[0].refusal);
  EXPECT_EQ(again.answers[0].revision.number, 1U);
  EXPECT_EQ(head_.graph().nodes.size(), 1U);
}

TEST_F(SequencerTest, RefusesOtherContentUnderATakenSequence) {
  take(step("a", 1));
  Transaction other = step("a", 1);
  other.variables[0].start[0] = 5.0;
  const auto outcome = take(other);
  ASSERT_EQ(outcome.answers.size(), 1U);
  EXPECT_EQ(outcome.answers[0].refusal, RefusalCode::kConflict);
  EXPECT_EQ(head_.graph().nodes.size(), 1U);
}

TEST_F(SequencerTest, CallsStaleWhatIsBeforeTheKeptDecisionsOrOfAClosedEpoch) {
  for (std::uint64_t sequence = 1; sequence <= 5; ++sequence) take(step("a", sequence));
  EXPECT_EQ(take(step("a", 2)).answers.at(0).refusal, RefusalCode::kStale);
  EXPECT_FALSE(take(step("a", 3)).answers.at(0).refusal);
  Transaction newer = step("a", 1, {}, 8);
  newer.variables[0].node.index = 100;
  EXPECT_EQ(take(newer).decisions.size(), 1U);
  EXPECT_EQ(take(step("a", 6)).answers.at(0).refusal, RefusalCode::kStale);
}

TEST_F(SequencerTest, UsesUpTheSequenceOfAFinalRefusal) {
  Transaction bad = step("a", 1);
  bad.variables[0].start = {1.0};
  const auto outcome = take(bad);
  ASSERT_EQ(outcome.decisions.size(), 1U);
  EXPECT_EQ(outcome.decisions[0].refusal, RefusalCode::kMalformed);
  EXPECT_EQ(head_.graph().nodes.size(), 0U);
  // The next one is decided, though what it ties to is not there: its own robot's, so for good.
  const auto second = take(step("a", 2));
  EXPECT_EQ(second.decisions.at(0).refusal, RefusalCode::kUnknownVariable);
}

TEST_F(SequencerTest, HoldsWhatTiesToAnotherSourceUntilThatHasCome) {
  take(step("a", 1));
  EXPECT_TRUE(take(step("a", 2, node("b", 1))).decisions.empty());
  EXPECT_TRUE(take(step("a", 3)).decisions.empty());  // in order, so it waits too
  const auto outcome = take(step("b", 1));
  ASSERT_EQ(outcome.decisions.size(), 3U);
  for (const Decision& decision : outcome.decisions) EXPECT_FALSE(decision.refusal);
}

TEST_F(SequencerTest, RefusesWhatWaitedTooLong) {
  take(step("a", 1));
  take(step("a", 2, node("b", 1)), 1000);
  Sequencer::Outcome outcome;
  sequencer_.expire({1050, head_, next(), outcome});
  EXPECT_TRUE(outcome.decisions.empty());
  sequencer_.expire({1100, head_, next(), outcome});
  ASSERT_EQ(outcome.decisions.size(), 1U);
  EXPECT_EQ(outcome.decisions[0].refusal, RefusalCode::kUnknownVariable);
  EXPECT_EQ(sequencer_.counters().at("a").refused, 1U);
}

TEST_F(SequencerTest, HoldsNoMoreThanItsBudget) {
  take(step("a", 1));
  for (std::uint64_t sequence = 3; sequence <= 16; ++sequence)
    EXPECT_TRUE(take(step("a", sequence)).answers.empty());
  const auto outcome = take(step("a", 17));
  ASSERT_EQ(outcome.answers.size(), 1U);
  EXPECT_EQ(outcome.answers[0].refusal, RefusalCode::kOverBudget);
  EXPECT_EQ(take(step("a", 2)).decisions.size(), 15U);  // the room that is needed is found
}

TEST_F(SequencerTest, TakesRoomFromWhoeverHasMost) {
  take(step("a", 1));
  take(step("b", 1));
  for (std::uint64_t sequence = 3; sequence <= 16; ++sequence) take(step("a", sequence));
  const auto outcome = take(step("b", 3));
  ASSERT_EQ(outcome.answers.size(), 1U);
  EXPECT_EQ(outcome.answers[0].key.source, "a");
  EXPECT_EQ(outcome.answers[0].key.sequence, 16U);
  EXPECT_EQ(sequencer_.counters().at("b").held, 1U);
  EXPECT_EQ(sequencer_.counters().at("a").refused_by_code.at(RefusalCode::kOverBudget), 1U);
}

TEST_F(SequencerTest, LetsInventedNamesTakeNothingFromKnownSources) {
  take(step("a", 1));
  for (int i = 0; i < 100; ++i) take(step("invented" + std::to_string(i), 2));
  for (std::uint64_t sequence = 3; sequence <= 16; ++sequence)
    EXPECT_TRUE(take(step("a", sequence)).answers.empty());
  EXPECT_EQ(sequencer_.counters().size(), 1U);
  EXPECT_EQ(take(step("b", 1)).decisions.size(), 1U);  // an honest newcomer
}

TEST_F(SequencerTest, RemembersFewSourcesThatSendOnlyRefusals) {
  const auto bad = [](const std::string& source) {
    Transaction transaction = step(source, 1);
    transaction.variables[0].start = {1.0};
    return transaction;
  };
  EXPECT_EQ(take(bad("x")).decisions.size(), 1U);
  EXPECT_EQ(take(bad("y")).decisions.size(), 1U);
  EXPECT_EQ(take(bad("z")).answers.at(0).refusal, RefusalCode::kOverBudget);
  EXPECT_EQ(sequencer_.counters().size(), 2U);
  EXPECT_EQ(take(step("z", 1)).decisions.size(), 1U);  // it has mended its ways
}

TEST_F(SequencerTest, DecidesWhatCannotBeReadInItsTurn) {
  const auto faulty = [](std::uint64_t sequence, const std::string& bytes) {
    Arrival arrival;
    arrival.transaction.key = {"a", 7, sequence};
    arrival.hash = content_hash(bytes);
    arrival.fault = Refusal{RefusalCode::kVersion, "has format version 2"};
    return arrival;
  };
  EXPECT_TRUE(take(faulty(2, "x")).decisions.empty());
  EXPECT_TRUE(take(step("a", 3)).decisions.empty());
  EXPECT_EQ(take(faulty(2, "y")).answers.at(0).refusal, RefusalCode::kConflict);
  const auto outcome = take(step("a", 1));
  ASSERT_EQ(outcome.decisions.size(), 3U);
  EXPECT_EQ(outcome.decisions[1].refusal, RefusalCode::kVersion);
  EXPECT_EQ(outcome.decisions[1].reason, "has format version 2");
  EXPECT_EQ(outcome.decisions[2].refusal, RefusalCode::kUnknownVariable);  // ties to pose 2
  EXPECT_EQ(take(faulty(2, "x")).answers.at(0).revision.number, 2U);
  EXPECT_EQ(take(faulty(2, "x")).answers.at(0).refusal, RefusalCode::kVersion);
  EXPECT_EQ(take(faulty(2, "y")).answers.at(0).refusal, RefusalCode::kConflict);
  EXPECT_EQ(head_.graph().nodes.size(), 1U);
}

TEST_F(SequencerTest, BeginsAnEpochWithItsFirstDecisionOnly) {
  take(step("a", 1));
  EXPECT_TRUE(take(step("a", 2, {}, 8)).decisions.empty());  // waits for the first of epoch 8
  EXPECT_EQ(take(step("a", 2)).decisions.size(), 1U);        // epoch 7 goes on
  EXPECT_TRUE(take(step("a", 4)).decisions.empty());
  Transaction newer = step("a", 1, {}, 8);
  newer.variables[0].node.index = 100;
  const auto outcome = take(newer);
  EXPECT_EQ(outcome.decisions.size(), 2U);
  ASSERT_EQ(outcome.answers.size(), 1U);
  EXPECT_EQ(outcome.answers[0].refusal, RefusalCode::kStale);  // 4 of epoch 7
}

TEST_F(SequencerTest, GoesOnBehindAGapThatNobodyCanFill) {
  const auto skip = [&](const std::string& source, std::uint64_t epoch, std::uint64_t first) {
    Sequencer::Outcome outcome;
    sequencer_.skip_to(source, epoch, first, {0, head_, next(), outcome});
    number_ += outcome.decisions.size();
    return outcome;
  };
  take(step("a", 1));
  EXPECT_TRUE(take(step("a", 5)).decisions.empty());
  EXPECT_EQ(skip("a", 7, 5).decisions.size(), 1U);
  EXPECT_TRUE(skip("a", 7, 3).decisions.empty());  // nothing to do
  EXPECT_TRUE(skip("b", 1, 9).decisions.empty());  // a store that never heard of it
  EXPECT_EQ(take(step("b", 9, {}, 1)).decisions.size(), 1U);
  EXPECT_EQ(sequencer_.highest_decided("b", 1), 9U);
}

TEST_F(SequencerTest, TurnsAwayAllThatWaits) {
  take(step("a", 1));
  take(step("a", 3));
  take(step("stranger", 2));
  const auto receipts = sequencer_.turn_away(RefusalCode::kStorageFull, "full", {1, 0, 1});
  ASSERT_EQ(receipts.size(), 2U);
  EXPECT_EQ(receipts[1].key.source, "stranger");
  EXPECT_EQ(sequencer_.counters().at("a").held, 0U);
}

TEST_F(SequencerTest, RemembersDecisionsThatAJournalTold) {
  const Transaction first = step("a", 1);
  sequencer_.replay(first.key, content_hash(encode(first)), std::nullopt, "", {1, 0, 1});
  head_.apply(first, {1, 0, 1});
  const auto again = take(first);
  ASSERT_EQ(again.answers.size(), 1U);
  EXPECT_FALSE(again.answers[0].refusal);
}

}  // namespace
}  // namespace cairn
