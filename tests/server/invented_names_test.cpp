// SPDX-License-Identifier: BSD-3-Clause
// Senders under names, with promises and in amounts that they have made up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <thread>

#include "clients/client/client.hpp"
#include "server/memory_transport.hpp"
#include "server/service.hpp"
#include "tests/server/drive.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/wire/listeners.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;

// Speaks without a client library.
struct Stranger {
  Stranger(const MemoryNetwork& network, std::string name, std::uint64_t epoch)
      : source(std::move(name)),
        link(network.make_link({source, epoch, std::hash<std::string>{}(source)})) {
    EXPECT_TRUE(link->start(heard));
    state = {.source = source, .epoch = epoch};
  }
  ~Stranger() { link->stop(); }
  /// Says that it is there, and then what it claims.
  SourceState introduce() {
    EXPECT_TRUE(link->send(state));
    const SourceState daemon = heard.source_states.wait_for(1).back();
    state.daemon_ns = daemon.daemon_ns;
    EXPECT_TRUE(link->send(state));
    heard.source_states.wait_for(2);
    return daemon;
  }

  std::string source;
  test::RecordingClient heard;
  std::unique_ptr<Link> link;
  ClientState state;
};

class ServiceInventedNames : public testing::Test {
 protected:
  void start(ServiceOptions options = {}) {
    options.solve_after_pause = 20ms;
    options.state_every = 10ms;
    options.on_event = [this](const Event& event) { damages_ += event.kind == "damage"; };
    service_.emplace(*journal_, *transport_, options);
    ASSERT_TRUE(service_->start());
  }
  Client connect(const char* spool) {
    return *Client::connect({.source = "test", .robot = "robot", .spool = folder_.path() / spool},
                            [this](Link::Identity who) { return network_.make_link(who); });
  }
  static void expect_accepted(Client& client, const Transaction& step) {
    const Result<Receipt> receipt = client.submit(step, 5s);
    ASSERT_TRUE(receipt) << receipt.error().to_string();
    EXPECT_FALSE(receipt->refusal) << receipt->reason;
  }

  test::TemporaryFolder folder_;
  MemoryNetwork network_;
  std::unique_ptr<Journal> journal_ = *Journal::open((folder_.path() / "data").string());
  std::unique_ptr<Transport> transport_ = network_.make_transport();
  std::atomic<int> damages_{0};
  std::optional<Service> service_;
  std::vector<Transaction> steps_ = test::drive(5);
};

TEST_F(ServiceInventedNames, DoNotMakeOthersWaitForPromisesThatWereNeverGiven) {
  start();
  Client client = connect("spool");
  expect_accepted(client, steps_[0]);
  const Revision head = journal_->head().revision;
  Stranger stranger(network_, "mallory", 4);
  stranger.state.highest_decided = 1'000'000'000;
  stranger.state.oldest_kept = 1;
  stranger.state.receipted = head;
  stranger.introduce();
  expect_accepted(client, steps_[1]);
  EXPECT_EQ(damages_, 0);
}

TEST_F(ServiceInventedNames, DoNotMakeOthersWaitForAnEpochThatWasClosed) {
  start();
  Stranger old(network_, "other", 4);
  old.state.oldest_kept = 1;
  old.introduce();
  for (const std::uint64_t epoch : {4, 5}) {
    Transaction step = steps_[0];
    step.key = {"other", epoch, 1};
    step.variables[0].node.frame = {"other", epoch};
    ASSERT_TRUE(old.link->send(step));
    if (epoch == 4) {
      ASSERT_EQ(old.heard.receipts.wait_for(1).size(), 1u);
      old.link->stop();
      old.link = network_.make_link({"other", 5, 77});
      ASSERT_TRUE(old.link->start(old.heard));
      old.state.epoch = 5;
      ASSERT_TRUE(old.link->send(old.state));
    }
  }
  ASSERT_EQ(old.heard.receipts.wait_for(2).size(), 2u);
  EXPECT_FALSE(old.heard.receipts.all().back().refusal);
  old.link->stop();
  old.link = network_.make_link({"other", 4, 78});  // the old spool once more
  ASSERT_TRUE(old.link->start(old.heard));
  old.state.epoch = 4;
  old.state.highest_decided = 1;
  old.state.oldest_kept = 9;
  old.state.receipted = journal_->head().revision;
  old.state.receipted.number += 100;
  ASSERT_TRUE(old.link->send(old.state));
  Client client = connect("spool");
  expect_accepted(client, steps_[0]);
  EXPECT_EQ(damages_, 0);
}

TEST_F(ServiceInventedNames, BringNoPayloadsBeforeTheyAreThere) {
  start();
  Stranger stranger(network_, "mallory", 4);
  Payload payload{.source = "mallory", .epoch = 4, .number = 1, .hash = content_hash("x")};
  payload.bytes = "x";
  ASSERT_TRUE(stranger.link->send(payload));
  EXPECT_EQ(stranger.heard.payload_receipts.wait_for(1).at(0).answer, PayloadAnswer::kBusy);
  EXPECT_FALSE(journal_->has_payload(payload.hash));
  stranger.introduce();
  Stranger thief(network_, "thief", 4);
  ASSERT_TRUE(thief.link->send(payload));  // under a living name that is not its own
  EXPECT_EQ(stranger.heard.payload_receipts.wait_for(2).at(1).answer, PayloadAnswer::kBusy);
  ASSERT_TRUE(stranger.link->send(payload));
  EXPECT_EQ(stranger.heard.payload_receipts.wait_for(3).at(2).answer, PayloadAnswer::kStored);
}

TEST_F(ServiceInventedNames, LeaveNoAnswersBehindWhereTheInboxIsFull) {
  start({.inbox_bytes = 1});
  Stranger first(network_, "first", 4);
  Transaction step = steps_[0];
  step.key = {"first", 4, 1};
  ASSERT_TRUE(first.link->send(step));
  EXPECT_EQ(first.heard.receipts.wait_for(1).at(0).refusal, RefusalCode::kOverBudget);
  const auto kept = [&] {
    test::RecordingClient heard;
    const auto late = network_.make_link({"first", 4, 9});
    EXPECT_TRUE(late->start(heard));
    EXPECT_TRUE(late->send(Command{{9, 1}, "status"}, 1000));  // answered: it is full
    EXPECT_EQ(heard.replies.wait_for(1).at(0).error, ErrorCode::kNotUsable);
    late->stop();
    return heard.receipts.all().size();
  };
  EXPECT_EQ(kept(), 1u);
  const auto other = network_.make_link({"other", 4, 8});
  test::RecordingClient nobody;
  ASSERT_TRUE(other->start(nobody));
  for (std::uint64_t epoch = 1; epoch <= 300; ++epoch) {
    step.key = {"name" + std::to_string(epoch), epoch, 1};
    ASSERT_TRUE(other->send(step));
  }
  for (int i = 0; i < 1000 && kept() > 0; ++i) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(kept(), 0u);
  other->stop();
}

TEST_F(ServiceInventedNames, WaitForASolveInBoundedNumbers) {
  std::atomic<bool> go_on{false};
  start({.on_point = [&](ServicePoint point) {
    while (point == ServicePoint::kSolving && !go_on) std::this_thread::sleep_for(1ms);
  }});
  Client client = connect("spool");
  for (const Transaction& step : steps_) expect_accepted(client, step);
  Stranger stranger(network_, "mallory", 4);
  const std::uint64_t writer = std::hash<std::string>{}("mallory");
  for (std::uint64_t i = 1; i <= 100; ++i)
    ASSERT_TRUE(stranger.link->send(Command{{writer, i}, "settle"}, 1000));
  EXPECT_EQ(stranger.heard.replies.wait_for(36).size(), 36u);
  for (const Reply& reply : stranger.heard.replies.all())
    EXPECT_THAT(reply.text, testing::StartsWith("busy: 64 commands wait"));
  go_on = true;
  EXPECT_EQ(stranger.heard.replies.wait_for(100).size(), 100u);
  service_.reset();
}

TEST(Refill, TakesNoMoreTimeThanThereIsInOneRun) {
  Refill refill({100ms, 5s, 12s});
  Refill::Clock::time_point now{};
  int refills = 0;
  for (std::uint64_t name = 1; name <= 100; ++name) {
    refill.expect({"name" + std::to_string(name), 1}, 10, now);
    if (!refill.active()) break;
    ++refills;
    while (!refill.end(now)) now += 10ms;
  }
  EXPECT_EQ(refills, 3);
  EXPECT_EQ(now - Refill::Clock::time_point{}, 12s);
  refill.begin(now);
  EXPECT_FALSE(refill.active());
}

TEST(Refill, IsNotProlongedByBeginningAnew) {
  Refill refill({100ms, 5s, 12s});
  Refill::Clock::time_point now{};
  refill.begin(now);
  for (; now < Refill::Clock::time_point{} + 12s; now += 1s) {
    refill.expect({"name", 1}, static_cast<std::uint64_t>(now.time_since_epoch().count()) + 1, now);
    refill.begin(now);
    EXPECT_FALSE(refill.end(now));
  }
  refill.begin(now);
  EXPECT_TRUE(refill.end(now));
}

}  // namespace
}  // namespace cairn
