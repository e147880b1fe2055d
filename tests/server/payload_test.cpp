// SPDX-License-Identifier: BSD-3-Clause
// Payloads from a client's disk into the journal's store, over memory and over the real middleware.
#include <gtest/gtest.h>

#include <chrono>

#include "clients/client/client.hpp"
#include "clients/client/payload_spool.hpp"
#include "server/dds_transport.hpp"
#include "server/memory_transport.hpp"
#include "server/service.hpp"
#include "tests/server/drive.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/wait_until.hpp"
#include "tests/wire/listeners.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;

using test::wait_until;

class PayloadTest : public testing::TestWithParam<bool> {
 protected:
  struct Daemon {
    Daemon(const std::filesystem::path& folder, std::unique_ptr<Transport> over)
        : journal(*Journal::open(folder.string())), transport(std::move(over)) {
      EXPECT_TRUE(service.start());
    }
    std::unique_ptr<Journal> journal;
    std::unique_ptr<Transport> transport;
    Service service{
        *journal,
        *transport,
        {.solve_after_pause = 20ms, .payloads = {.patience = 100ms, .ask_again = 200ms}}};
  };
  std::unique_ptr<Daemon> start_daemon() {
    return std::make_unique<Daemon>(
        folder_.path() / "data",
        GetParam() ? make_dds_transport({.domain = domain_}) : network_.make_transport());
  }
  Client connect() {
    const ClientOptions options{
        .domain = domain_, .source = "test", .robot = "robot", .spool = folder_.path() / "spool"};
    if (GetParam()) return *Client::connect(options);
    return *Client::connect(options,
                            [this](Link::Identity who) { return network_.make_link(who); });
  }
  static std::string scan(int number) {
    return std::string(20'000, static_cast<char>('a' + number % 26)) + std::to_string(number);
  }

  test::TemporaryFolder folder_;
  MemoryNetwork network_;
  std::uint32_t domain_ = GetParam() ? test::own_domain() : 0;
};

TEST_P(PayloadTest, StoresMoreThanTheWindowAndKeepsNothingOnTheClientsDisk) {
  const auto daemon = start_daemon();
  Client client = connect();
  std::vector<ContentHash> hashes;
  for (int i = 0; i < 50; ++i) {
    const auto hash = client.send_payload("laser_scan/1", scan(i));
    ASSERT_TRUE(hash) << hash.error().to_string();
    hashes.push_back(*hash);
  }
  ASSERT_TRUE(wait_until([&] { return client.unstored_payloads() == 0; }));
  for (int i = 0; i < 50; ++i) EXPECT_EQ(*daemon->journal->read_payload(hashes[i]), scan(i));
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path() / "spool" / "payloads"));
}

TEST_P(PayloadTest, KeepsThemOverRestartsOfEitherSide) {
  std::vector<ContentHash> hashes;
  {
    Client client = connect();
    for (int i = 0; i < 20; ++i) hashes.push_back(*client.send_payload("image/1", scan(i)));
  }
  Client client = connect();
  EXPECT_EQ(client.unstored_payloads(), 20u);
  start_daemon().reset();
  const auto daemon = start_daemon();
  ASSERT_TRUE(wait_until([&] { return client.unstored_payloads() == 0; }));
  for (const ContentHash& hash : hashes) EXPECT_TRUE(daemon->journal->has_payload(hash));
}

INSTANTIATE_TEST_SUITE_P(Over, PayloadTest, testing::Bool(), [](const auto& over) {
  return over.param ? std::string("Dds") : std::string("Memory");
});

// Speaks for itself: a client that sends what it wants and keeps what it hears.
TEST(PayloadStore, RefusesWrongHashesAndAsksForWhatTransactionsName) {
  const test::TemporaryFolder folder;
  const MemoryNetwork network;
  const auto journal = *Journal::open((folder.path() / "data").string());
  const auto transport = network.make_transport();
  test::RecordingDaemon nobody;
  ASSERT_TRUE(transport->start(nobody));
  const auto link = network.make_link({.source = "s", .epoch = 5, .writer = 1});
  test::RecordingClient client;
  ASSERT_TRUE(link->start(client));
  PayloadStore store(*journal, *transport, {.patience = 20ms, .ask_again = 50ms},
                     [](Severity, const std::string& text) { ADD_FAILURE() << text; });
  store.start();
  Payload payload{.source = "s", .epoch = 5, .number = 1, .hash = content_hash("x")};
  payload.bytes = "y";
  store.take(payload);
  EXPECT_EQ(client.payload_receipts.wait_for(1).at(0).answer, PayloadAnswer::kRefused);
  store.expect({"s", 5}, payload.hash);
  const PayloadReceipt question = client.payload_receipts.wait_for(2).at(1);
  EXPECT_EQ(question.answer, PayloadAnswer::kWanted);
  EXPECT_EQ(question.hash, payload.hash);
  payload.bytes = "x";
  store.take(payload);
  for (std::size_t count = 3; count < 20; ++count)  // questions may have gone out meanwhile
    if (client.payload_receipts.wait_for(count).back().answer == PayloadAnswer::kStored) break;
  EXPECT_EQ(client.payload_receipts.all().back().answer, PayloadAnswer::kStored);
  EXPECT_TRUE(journal->has_payload(payload.hash));
  store.stop();
  link->stop();
  transport->stop();
}

TEST(PayloadStore, DeletesWhatNobodyNamesAndSaysSo) {
  const test::TemporaryFolder folder;
  const MemoryNetwork network;
  const auto journal = *Journal::open((folder.path() / "data").string());
  const auto transport = network.make_transport();
  test::RecordingDaemon nobody;
  ASSERT_TRUE(transport->start(nobody));
  test::Inbox<std::string> told;
  PayloadStore store(*journal, *transport,
                     {.patience = 10ms, .keep_unnamed = 0ms, .collect_every = 10ms},
                     [&](Severity, const std::string& text) { told.add(text); });
  store.start();
  Payload payload{.source = "s", .epoch = 5, .number = 1, .hash = content_hash("x")};
  payload.bytes = "x";
  store.take(payload);
  EXPECT_EQ(told.wait_for(1).at(0), "1 payloads deleted that no transaction has named for 0 days");
  EXPECT_FALSE(journal->has_payload(payload.hash));
  store.stop();
  transport->stop();
}

TEST(PayloadSpool, KeepsWholePayloadsAndSaysWhichOneIsDamaged) {
  const test::TemporaryFolder folder;
  {
    auto spool = PayloadSpool::open(folder.path(), 1000);
    ASSERT_TRUE(spool);
    EXPECT_EQ(*spool->append("scan/1", "some bytes\nand more"), 1u);
    EXPECT_EQ(*spool->append("scan/1", ""), 2u);
    const auto full = spool->append("scan/1", std::string(1000, 'x'));
    ASSERT_FALSE(full);
    EXPECT_TRUE(full.error().message.starts_with("spool full")) << full.error().message;
  }
  auto spool = PayloadSpool::open(folder.path(), 1000);
  ASSERT_TRUE(spool);
  EXPECT_EQ(spool->kept().size(), 2u);
  EXPECT_EQ(spool->read(1)->bytes, "some bytes\nand more");
  EXPECT_EQ(spool->read(1)->type, "scan/1");
  spool->remove(2);
  EXPECT_EQ(*spool->append("scan/1", "third"), 3u);
  std::filesystem::resize_file(folder.path() / "1.payload", 90);
  const auto damaged = PayloadSpool::open(folder.path(), 1000);
  ASSERT_FALSE(damaged);
  EXPECT_TRUE(damaged.error().place.ends_with("1.payload"));
}

}  // namespace
}  // namespace cairn
