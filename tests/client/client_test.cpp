// SPDX-License-Identifier: BSD-3-Clause
#include "clients/client/client.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ctime>
#include <fstream>
#include <thread>

#include "clients/client/outgoing.hpp"
#include "server/dds_transport.hpp"
#include "server/memory_transport.hpp"
#include "tests/client/fake_daemon.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/wire/listeners.hpp"
#include "tests/wire/messages.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::Ge;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr auto kLong = 10s;

// The same tests over memory and over the real middleware.
class ClientTest : public testing::TestWithParam<bool> {
 protected:
  MemoryNetwork network_;
  test::FakeStore store_;
  test::TemporaryFolder folder_;
  test::Inbox<std::string> troubles_;

  static std::uint32_t domain() { return test::own_domain(); }
  [[nodiscard]] std::unique_ptr<Transport> make_transport() const {
    return GetParam() ? make_dds_transport({.domain = domain()}) : network_.make_transport();
  }
  std::unique_ptr<test::FakeDaemon> make_daemon() {
    return std::make_unique<test::FakeDaemon>(make_transport(), store_);
  }
  std::unique_ptr<test::FakeDaemon> start_daemon() {
    auto daemon = make_daemon();
    EXPECT_TRUE(daemon->start());
    return daemon;
  }
  [[nodiscard]] ClientOptions options(const std::string& source = "wheels") const {
    return {.domain = domain(),
            .source = source,
            .robot = "r",
            .spool = folder_.path() / source,
            .retry_first = 1ms};
  }
  Result<Client> try_connect(const ClientOptions& options) {
    if (GetParam()) return Client::connect(options);
    return Client::connect(options, [this](Link::Identity who) { return network_.make_link(who); });
  }
  Client connect(const ClientOptions& options) {
    auto client = try_connect(options);
    EXPECT_TRUE(client) << (client ? "" : client.error().to_string());
    client->on_trouble([this](const Error& error) { troubles_.add(error.to_string()); });
    return std::move(*client);
  }
  Client connect() { return connect(options()); }
  // Sequence and revision that a client says it was promised are those of one receipt.
  void TearDown() override { EXPECT_EQ(store_.claims_never_promised, 0); }
  static Transaction any() { return test::step("r", 0, 1); }
};

TEST_P(ClientTest, SubmitsAndGetsTheReceipt) {
  const auto daemon = start_daemon();
  Client client = connect();
  const auto receipt = client.submit(any(), kLong);
  ASSERT_TRUE(receipt) << receipt.error().to_string();
  EXPECT_EQ(receipt->key.source, "wheels");
  EXPECT_EQ(receipt->key.sequence, 1u);
  EXPECT_FALSE(receipt->refusal);
  EXPECT_EQ(client.submit(any(), kLong)->key.sequence, 2u);
  EXPECT_EQ(client.undecided(), 0u);
  EXPECT_THAT(troubles_.all(), IsEmpty());
}

TEST_P(ClientTest, TriesAgainWhatTheDaemonCouldNotTakeNow) {
  const auto daemon = make_daemon();
  daemon->decide_by([refusals = 0](const Transaction&) mutable {
    return refusals++ < 5 ? std::optional(RefusalCode::kBusy) : std::nullopt;
  });
  ASSERT_TRUE(daemon->start());
  Client client = connect();
  const auto receipt = client.submit(any(), kLong);
  ASSERT_TRUE(receipt) << receipt.error().to_string();
  EXPECT_FALSE(receipt->refusal);
}

TEST_P(ClientTest, HandsFinalRefusalsToTheCallerAndGoesOn) {
  const auto daemon = make_daemon();
  daemon->decide_by([](const Transaction& transaction) {
    return transaction.key.sequence == 1 ? std::optional(RefusalCode::kUnknownVariable)
                                         : std::nullopt;
  });
  ASSERT_TRUE(daemon->start());
  Client client = connect();
  EXPECT_EQ(client.submit(any(), kLong)->refusal, RefusalCode::kUnknownVariable);
  EXPECT_FALSE(client.submit(any(), kLong)->refusal);
}

TEST_P(ClientTest, WaitsWhileAnotherProgramHasItsNameAndSaysSoOnce) {
  const auto daemon = make_daemon();
  daemon->decide_by([offers = 0](const Transaction&) mutable {
    return ++offers % 4 != 0 ? std::optional(RefusalCode::kForeignSource) : std::nullopt;
  });
  ASSERT_TRUE(daemon->start());
  test::Inbox<Receipt> refusals;
  Client client = connect();
  client.on_refusals([&](const Receipt& receipt) { refusals.add(receipt); });
  for (std::size_t episode = 1; episode <= 2; ++episode) {
    const auto receipt = client.submit(any(), kLong);
    ASSERT_TRUE(receipt) << receipt.error().to_string();
    EXPECT_FALSE(receipt->refusal);
    ASSERT_EQ(troubles_.all().size(), episode);
    EXPECT_THAT(troubles_.all().back(), HasSubstr("another program lives under this source name"));
  }
  EXPECT_THAT(refusals.all(), IsEmpty());
}

TEST_P(ClientTest, HasAtMostTheWindowInFlightAndKeepsTheRestOnDisk) {
  const auto daemon = make_daemon();
  daemon->pause();
  ASSERT_TRUE(daemon->start());
  Client client = connect();
  std::vector<Submission> submissions;
  for (int i = 0; i < 1000; ++i) submissions.push_back(*client.submit_async(any()));
  ASSERT_TRUE(daemon->wait_held(256));
  ASSERT_TRUE(client.command("ping", kLong));  // time for one too many
  EXPECT_EQ(daemon->held(), 256u);
  EXPECT_EQ(client.undecided(), 1000u);
  daemon->resume();
  for (const Submission& submission : submissions) EXPECT_TRUE(submission.wait(kLong));
  EXPECT_EQ(store_.decided.begin()->second.size(), 1000u);
}

TEST_P(ClientTest, WaitsForADaemonAndSurvivesItsOwnRestart) {
  {
    Client client = connect();
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(client.submit_async(any()));
    const auto late = client.submit(any(), 1ms);
    ASSERT_FALSE(late);
    EXPECT_EQ(late.error().code, ErrorCode::kUnreachable);
    EXPECT_THAT(late.error().message, HasSubstr("no receipt for transaction 21 within 1 ms"));
  }
  Client client = connect();
  EXPECT_EQ(client.undecided(), 21u) << "of the run before, and nobody has said otherwise";
  const auto daemon = start_daemon();
  const auto receipt = client.submit(any(), kLong);
  ASSERT_TRUE(receipt) << receipt.error().to_string();
  EXPECT_EQ(receipt->key.sequence, 22u);
  EXPECT_EQ(store_.decided.size(), 1u);  // one epoch
  EXPECT_EQ(store_.decided.begin()->second.size(), 22u);
}

TEST_P(ClientTest, SurvivesARestartOfTheDaemon) {
  Client client = connect();
  std::vector<Submission> submissions;
  for (int round = 0; round < 3; ++round) {
    const auto daemon = start_daemon();
    for (int i = 0; i < 300; ++i) submissions.push_back(*client.submit_async(any()));
    ASSERT_TRUE(daemon->wait_decided(static_cast<std::size_t>(round) * 300 + 100));
  }
  const auto daemon = start_daemon();
  for (const Submission& submission : submissions) {
    const auto receipt = submission.wait(kLong);
    ASSERT_TRUE(receipt) << receipt.error().to_string();
    EXPECT_EQ(receipt->key, submission.key());
  }
  EXPECT_EQ(store_.decided.begin()->second.size(), 900u);
  EXPECT_EQ(store_.head.number, 900u);  // each once
}

TEST_P(ClientTest, RefillsAStoreThatLostItsTail) {
  const auto daemon = start_daemon();
  Client client = connect();
  std::vector<Submission> submissions;
  for (int i = 0; i < 600; ++i) submissions.push_back(*client.submit_async(any()));
  for (const Submission& submission : submissions) ASSERT_TRUE(submission.wait(kLong));
  // So slowly that the client speaks of what it was promised meanwhile.
  daemon->decide_by([](const Transaction&) {
    std::this_thread::sleep_for(1ms);
    return std::nullopt;
  });
  daemon->lose_tail(10);
  ASSERT_TRUE(daemon->wait_decided(600));
  EXPECT_EQ(client.submit(any(), kLong)->key.sequence, 601u);
  EXPECT_THAT(troubles_.all(), IsEmpty());
}

// What the first daemon has decided is known from receipts alone: its last state said nothing.
TEST_P(ClientTest, RefillsANewDaemonWhoseStoreHasLessThanItsReceipts) {
  Client client = connect();
  {
    const auto daemon = make_daemon();
    daemon->tell_no_marks();
    ASSERT_TRUE(daemon->start());
    for (int i = 0; i < 10; ++i) ASSERT_TRUE(client.submit(any(), kLong));
  }
  store_.decided.begin()->second.resize(5);
  const auto daemon = start_daemon();
  const auto receipt = client.submit(any(), kLong);
  ASSERT_TRUE(receipt) << receipt.error().to_string();
  EXPECT_EQ(receipt->key.sequence, 11u);
  EXPECT_EQ(store_.decided.begin()->second.size(), 11u);
}

// Zeros may follow.
std::uint64_t end_of_records(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::uint64_t end = 0;
  for (std::uint32_t length = 0; in.seekg(static_cast<std::streamoff>(end)) &&
                                 in.read(reinterpret_cast<char*>(&length), sizeof length) &&
                                 length > 0;)
    end += 16 + length;
  return end;
}

TEST_P(ClientTest, SaysThatARecordIsDamagedAndThenRests) {
  Client client = connect();
  const auto file = options().spool / "00000000000000000001.spool";
  std::uint64_t size = 0;
  for (int i = 0; i < 2; ++i) {
    const auto before = size;
    ASSERT_TRUE(client.submit_async(any()));
    for (int tries = 0; tries < 1000 && (size = end_of_records(file)) == before; ++tries)
      std::this_thread::sleep_for(10ms);
    ASSERT_GT(size, before);
  }
  std::fstream(file, std::ios::in | std::ios::out | std::ios::binary)
      .seekp(static_cast<std::streamoff>(size - 1))
      .put('\xFF');
  const auto daemon = make_daemon();
  daemon->pause();
  ASSERT_TRUE(daemon->start());
  ASSERT_THAT(troubles_.wait_for(1), SizeIs(Ge(1)));
  std::this_thread::sleep_for(Outgoing::kFirstPatience);  // transaction 1 would be sent again
  const std::clock_t before = std::clock();
  std::this_thread::sleep_for(500ms);
  EXPECT_LT(std::clock() - before, CLOCKS_PER_SEC / 4);
  EXPECT_THAT(troubles_.wait_for(1), ElementsAre(HasSubstr("sequence 2 is damaged")));
}

TEST_P(ClientTest, SaysThatTheSpoolIsFull) {
  ClientOptions small = options();
  small.spool_most_bytes = 4000;
  Client client = connect(small);
  Result<Submission> submission = client.submit_async(any());
  std::uint64_t taken = 0;
  for (; submission; submission = client.submit_async(any())) ++taken;
  EXPECT_EQ(submission.error().code, ErrorCode::kNotUsable);
  EXPECT_THAT(submission.error().message, HasSubstr("spool full"));
  EXPECT_GT(taken, 3u);
  const auto daemon = start_daemon();
  ASSERT_TRUE(daemon->wait_decided(taken));
}

TEST_P(ClientTest, RefusesWhatTheWireCannotCarry) {
  Client client = connect();
  Transaction bad = any();
  bad.factors[0].numbers.resize(300);
  const auto refused = client.submit(bad, kLong);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "factors[0]: numbers has 300 entries; expected at most 256");
  EXPECT_EQ(client.undecided(), 0u);
}

TEST_P(ClientTest, ShowsPosesAndWaitsForRevisions) {
  const auto daemon = start_daemon();
  test::Inbox<PoseUpdate> updates;
  Client client = connect();
  const Revision two{.store = 9, .era = 0, .number = 2};
  EXPECT_EQ(client.wait_for(two, 1ms).error().code, ErrorCode::kUnreachable);
  daemon->transport().publish_poses(test::revisions(2, 1), {test::chunk("a", 0, 5)});
  ASSERT_TRUE(client.wait_for(two, kLong));
  EXPECT_FALSE(client.wait_solved(two, 1ms));

  // A callback that comes late sees everything.
  client.on_poses([&](const PoseUpdate& update) { updates.add(update); });
  ASSERT_EQ(updates.all().size(), 1u);
  EXPECT_EQ(updates.all()[0].chunks[0], test::chunk("a", 0, 5));
  daemon->transport().publish_poses(test::revisions(3, 2), {test::chunk("a", 0, 6)});
  ASSERT_TRUE(client.wait_solved(two, kLong));
  ASSERT_EQ(updates.wait_for(2).size(), 2u);
  EXPECT_EQ(updates.all()[1].chunks[0].poses.size(), 6u);
  EXPECT_EQ(client.wait_for({.store = 8, .era = 0, .number = 1}, kLong).error().code,
            ErrorCode::kNotUsable);
}

TEST_P(ClientTest, ShowsCorrections) {
  const auto daemon = start_daemon();
  test::Inbox<Correction> corrections;
  Client client = connect();
  client.on_corrections([&](const Correction& correction) { corrections.add(correction); });
  daemon->transport().publish(Correction{.frame = {"a", 1}, .jump_m = 0.5});
  ASSERT_EQ(corrections.wait_for(1).size(), 1u);
  EXPECT_EQ(corrections.all()[0].jump_m, 0.5);
}

TEST_P(ClientTest, CarriesCommandsAndTheirErrors) {
  ClientOptions watcher{.domain = domain()};
  Client client = connect(watcher);
  EXPECT_EQ(client.command("ping", 1ms).error().code, ErrorCode::kUnreachable);
  const auto daemon = start_daemon();
  EXPECT_EQ(*client.command("ping", kLong), "pong");
  const auto unknown = client.command("fly", kLong);
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kUsage);
  EXPECT_EQ(unknown.error().message, "no such verb: fly");
  EXPECT_EQ(client.submit(any(), kLong).error().message,
            "connect with a source to submit transactions");
}

TEST_P(ClientTest, RefusesToWaitInsideACallback) {
  const auto daemon = start_daemon();
  test::Inbox<ErrorCode> answers;
  Client client = connect();
  client.on_corrections([&](const Correction&) {
    answers.add(client.submit(any(), kLong).error().code);
    answers.add(client.wait_for({}, kLong).error().code);
    answers.add(client.submit_async(any()).ok() ? ErrorCode::kUnreachable : ErrorCode::kInternal);
  });
  daemon->transport().publish(Correction{.frame = {"a", 1}});
  EXPECT_EQ(answers.wait_for(3),
            (std::vector{ErrorCode::kUsage, ErrorCode::kUsage, ErrorCode::kUnreachable}));
}

TEST_P(ClientTest, HoldsItsSpoolAlone) {
  Client client = connect();
  const auto second = try_connect(options());
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("in use by another process"));
}

TEST_P(ClientTest, SeveralSourcesDoNotDisturbEachOther) {
  const auto daemon = start_daemon();
  Client wheels = connect(), sonar = connect(options("sonar"));
  std::vector<Submission> submissions;
  for (int i = 0; i < 400; ++i) {
    submissions.push_back(*wheels.submit_async(any()));
    submissions.push_back(*sonar.submit_async(any()));
  }
  for (const Submission& submission : submissions)
    EXPECT_EQ(submission.wait(kLong)->key, submission.key());
}

TEST_P(ClientTest, TellsTheDaemonThatItEnds) {
  const auto daemon = start_daemon();
  {
    Client client = connect();
    ASSERT_TRUE(client.submit(any(), kLong));
  }
  EXPECT_TRUE(daemon->wait_lost());
}

INSTANTIATE_TEST_SUITE_P(Over, ClientTest, testing::Bool(), [](const auto& over) {
  return over.param ? std::string("Dds") : std::string("Memory");
});

}  // namespace
}  // namespace cairn
