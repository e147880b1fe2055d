// SPDX-License-Identifier: BSD-3-Clause
#include "server/writers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cairn {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

ClientState client(const std::string& source, std::uint64_t epoch, std::int64_t sent_ns = 0) {
  ClientState state;
  state.source = source;
  state.epoch = epoch;
  state.sent_ns = sent_ns;
  return state;
}

class WritersTest : public testing::Test {
 protected:
  std::optional<RefusalCode> refusal(const std::string& source, std::uint64_t epoch,
                                     std::uint64_t writer) {
    const auto refused = writers_.refuse({source, epoch, 1}, {.writer = writer});
    return refused ? std::optional(refused->code) : std::nullopt;
  }

  std::map<Writers::Spool, std::uint64_t> decided_;
  Writers writers_{[this](const Writers::Spool& spool) { return decided_[spool]; }, 2};
};

TEST_F(WritersTest, GiveASourceToTheFirstUntilItIsGone) {
  EXPECT_TRUE(writers_.arrive(client("a", 7), {.writer = 1}));
  EXPECT_FALSE(writers_.arrive(client("a", 7), {.writer = 2}));
  EXPECT_EQ(refusal("a", 7, 1), std::nullopt);
  EXPECT_EQ(refusal("a", 7, 2), RefusalCode::kBusy);
  EXPECT_EQ(refusal("a", 8, 2), RefusalCode::kForeignSource);
  writers_.lose("a", 2);  // not the owner
  EXPECT_EQ(refusal("a", 7, 2), RefusalCode::kBusy);
  writers_.lose("a", 1);
  EXPECT_TRUE(writers_.arrive(client("a", 7), {.writer = 2}));
  EXPECT_EQ(refusal("a", 7, 1), RefusalCode::kBusy);  // a frozen program that wakes up
}

TEST_F(WritersTest, PreferTheSpoolThatTheJournalKnows) {
  decided_[{"a", 7}] = 5;
  EXPECT_TRUE(writers_.arrive(client("a", 8), {.writer = 1}));  // the other's lease has ended
  EXPECT_TRUE(writers_.arrive(client("a", 7), {.writer = 2}));  // or the daemon has restarted
  EXPECT_EQ(refusal("a", 8, 1), RefusalCode::kForeignSource);
}

TEST_F(WritersTest, LetThoseWaitWhoHaveNotSaidThatTheyAreThere) {
  EXPECT_EQ(refusal("a", 7, 1), RefusalCode::kBusy);
  writers_.arrive(client("a", 7), {.writer = 1});
  EXPECT_EQ(refusal("a", 7, 1), std::nullopt);
}

TEST_F(WritersTest, RememberFewOfWhomTheJournalHasNothing) {
  decided_[{"known", 1}] = 1;
  writers_.arrive(client("known", 1), {.writer = 9});
  writers_.arrive(client("a", 1), {.writer = 1});
  EXPECT_EQ(refusal("b", 1, 2), RefusalCode::kBusy);
  writers_.arrive(client("a", 1), {.writer = 1});  // heard of again
  writers_.arrive(client("c", 1), {.writer = 3});
  EXPECT_THAT(writers_.remove_excess_strangers(), ElementsAre(Writers::Spool{"b", 1}));
  decided_[{"a", 1}] = 1;  // no stranger any more
  writers_.arrive(client("d", 1), {.writer = 4});
  EXPECT_THAT(writers_.remove_excess_strangers(), IsEmpty());
  writers_.arrive(client("e", 1), {.writer = 5});
  EXPECT_THAT(writers_.remove_excess_strangers(), ElementsAre(Writers::Spool{"c", 1}));
  EXPECT_EQ(writers_.owners().size(), 4U);  // known, a, d, e
}

TEST_F(WritersTest, SayOfWhomNothingNeedBeKept) {
  decided_[{"known", 1}] = 1;
  writers_.arrive(client("known", 1), {.writer = 9});
  writers_.arrive(client("a", 1), {.writer = 1});
  EXPECT_EQ(writers_.lose("known", 9), std::nullopt);
  EXPECT_EQ(writers_.lose("a", 1), (Writers::Spool{"a", 1}));
  EXPECT_FALSE(writers_.owners().at("known").alive);
  EXPECT_FALSE(writers_.owners().contains("a"));
}

TEST(ClockOffset, IsTheLeastDelayedDifferenceOfTheLastMinutes) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  ClockOffset offset;
  EXPECT_EQ(offset.value_ns(), std::nullopt);
  offset.add(500 - 40, 0);  // 500 ahead, delayed by 40
  offset.add(kSecond + 500 - 3, kSecond);
  offset.add(2 * kSecond + 500 - 90, 2 * kSecond);
  EXPECT_EQ(offset.value_ns(), 497);
  offset.add(70 * kSecond + 300, 70 * kSecond);  // the clock was set back; the last period counts
  EXPECT_EQ(offset.value_ns(), 497);
  offset.add(140 * kSecond + 290, 140 * kSecond);
  EXPECT_EQ(offset.value_ns(), 300);
}

}  // namespace
}  // namespace cairn
