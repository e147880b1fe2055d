// SPDX-License-Identifier: BSD-3-Clause
#include "clients/client/outgoing.hpp"

#include <gtest/gtest.h>

namespace cairn {
namespace {

using namespace std::chrono_literals;
using Clock = Outgoing::Clock;

constexpr Clock::time_point kStart{1h};

Transaction transaction(std::uint64_t sequence) {
  Transaction t;
  t.key = {"source", 1, sequence};
  return t;
}

Receipt receipt(std::uint64_t sequence, std::optional<RefusalCode> refusal = {}) {
  return {{"source", 1, sequence}, {}, refusal, ""};
}

// Which sequences are due.
std::vector<std::uint64_t> due(Outgoing& outgoing, Clock::time_point now) {
  std::vector<std::uint64_t> sequences;
  for (const Transaction* t : outgoing.due(now)) sequences.push_back(t->key.sequence);
  return sequences;
}

Outgoing with_in_flight(std::uint64_t count) {
  Outgoing outgoing(1, {20ms, 5000ms});
  for (std::uint64_t sequence = 1; sequence <= count; ++sequence)
    outgoing.sent(transaction(sequence), kStart);
  return outgoing;
}

using Sequences = std::vector<std::uint64_t>;

TEST(Outgoing, SendsEverythingAgainWhenNothingIsHeard) {
  Outgoing outgoing = with_in_flight(3);
  EXPECT_EQ(outgoing.next_retry(), kStart + 1s);
  EXPECT_EQ(due(outgoing, kStart + 999ms), Sequences());
  EXPECT_EQ(due(outgoing, kStart + 1s), (Sequences{1, 2, 3}));
  EXPECT_EQ(due(outgoing, kStart + 2999ms), Sequences());
  EXPECT_EQ(due(outgoing, kStart + 3s), (Sequences{1, 2, 3}));  // two seconds later
  Clock::time_point last = kStart + 3s;
  for (const auto pause : {4s, 8s, 10s, 10s}) {
    EXPECT_EQ(outgoing.next_retry(), last + pause);
    EXPECT_EQ(due(outgoing, last + pause), (Sequences{1, 2, 3}));
    last += pause;
  }
}

TEST(Outgoing, WaitsAsLongAsReceiptsCome) {
  Outgoing outgoing = with_in_flight(3);
  ASSERT_EQ(due(outgoing, kStart + 1s).size(), 3U);
  EXPECT_TRUE(outgoing.receive(receipt(1), kStart + 2s));
  EXPECT_EQ(due(outgoing, kStart + 2999ms), Sequences());
  EXPECT_EQ(due(outgoing, kStart + 3s), (Sequences{2, 3}));
  EXPECT_TRUE(outgoing.receive(receipt(2), kStart + 4s));
  EXPECT_TRUE(outgoing.receive(receipt(3), kStart + 4s));
  EXPECT_FALSE(outgoing.next_retry());  // nothing is in flight
  outgoing.sent(transaction(4), kStart + 60s);
  EXPECT_EQ(outgoing.next_retry(), kStart + 61s);
}

TEST(Outgoing, LeavesWhatWasRefusedForNowItsOwnTime) {
  Outgoing outgoing = with_in_flight(2);
  EXPECT_FALSE(outgoing.receive(receipt(1, RefusalCode::kStorageFull), kStart));
  EXPECT_EQ(outgoing.next_retry(), kStart + 20ms);
  EXPECT_EQ(due(outgoing, kStart + 20ms), Sequences{1});
  EXPECT_FALSE(outgoing.receive(receipt(1, RefusalCode::kStorageFull), kStart + 30ms));
  EXPECT_EQ(due(outgoing, kStart + 69ms), Sequences());
  EXPECT_EQ(due(outgoing, kStart + 70ms), Sequences{1});
}

}  // namespace
}  // namespace cairn
