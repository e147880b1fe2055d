// SPDX-License-Identifier: BSD-3-Clause
#include "server/service.hpp"

#include <gtest/gtest.h>

#include "clients/client/client.hpp"
#include "server/memory_transport.hpp"
#include "tests/client/temporary_folder.hpp"
#include "tests/server/drive.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;
using test::drive;
using test::estimates;

// A daemon on a folder and an in-memory network, and a client of it.
struct Station {
  explicit Station(const std::filesystem::path& folder)
      : journal(*Journal::open((folder / "data").string())),
        transport(network.make_transport()),
        service(*journal, *transport, {.solve_after_pause = 20ms}),
        client(*Client::connect(
            {.source = "test", .robot = "robot", .spool = folder / "spool"},
            [this](Link::Identity identity) { return network.make_link(std::move(identity)); })) {
    EXPECT_TRUE(service.start());
  }

  MemoryNetwork network;
  std::unique_ptr<Journal> journal;
  std::unique_ptr<Transport> transport;
  Service service;
  Client client;
};

TEST(Service, ReceiptsSolvesAndPublishesWhatAClientSends) {
  const test::TemporaryFolder folder;
  Station station(folder.path());
  Receipt last;
  for (const Transaction& step : drive(60)) {
    const Result<Receipt> receipt = station.client.submit(step, 10s);
    ASSERT_TRUE(receipt) << receipt.error().to_string();
    ASSERT_FALSE(receipt->refusal) << receipt->reason;
    last = *receipt;
  }
  EXPECT_GE(last.revision.number, 60U);  // solves are records too
  ASSERT_TRUE(station.client.wait_for(last.revision, 10s));
  ASSERT_TRUE(station.client.wait_solved(last.revision, 30s));
  const Result<std::string> settled = station.client.command("settle", 30s);
  ASSERT_TRUE(settled) << settled.error().to_string();
  EXPECT_TRUE(settled->starts_with("settled at ")) << *settled;

  EXPECT_EQ(estimates(*station.journal), test::settled_estimates(drive(60)));
}

TEST(Service, GoesOnWhereItWasAfterARestart) {
  const test::TemporaryFolder folder;
  const std::vector<Transaction> steps = drive(40);
  std::vector<double> before;
  JournalHead head_before;
  {
    Station station(folder.path());
    for (std::size_t i = 0; i < 20; ++i) ASSERT_TRUE(station.client.submit(steps[i], 10s));
    ASSERT_TRUE(station.client.command("settle", 30s));
    station.service.stop();
    before = estimates(*station.journal);
    head_before = station.journal->head();
  }
  Station station(folder.path());
  EXPECT_EQ(station.journal->head(), head_before);
  EXPECT_EQ(estimates(*station.journal), before);
  for (std::size_t i = 20; i < 40; ++i) {
    const Result<Receipt> receipt = station.client.submit(steps[i], 10s);
    ASSERT_TRUE(receipt) << receipt.error().to_string();
    EXPECT_FALSE(receipt->refusal) << receipt->reason;
    EXPECT_EQ(receipt->key.sequence, i + 1);  // the spool goes on
  }
  EXPECT_TRUE(station.journal->verify());
}

TEST(Service, HandsAFinalRefusalToTheCallerAndKeepsTheMap) {
  const test::TemporaryFolder folder;
  Station station(folder.path());
  Transaction unknown = drive(2)[1];  // ties to pose 0, which is not there
  const Result<Receipt> receipt = station.client.submit(unknown, 10s);
  ASSERT_TRUE(receipt) << receipt.error().to_string();
  EXPECT_EQ(receipt->refusal, RefusalCode::kUnknownVariable);
  EXPECT_EQ(receipt->reason, "factor 0: the node robot/3/0 is not known");
  EXPECT_TRUE(estimates(*station.journal).empty());
  const Result<std::string> reply = station.client.command("dance", 10s);
  ASSERT_FALSE(reply);
  EXPECT_EQ(reply.error().message, "unknown command 'dance'; known: settle");
}

}  // namespace
}  // namespace cairn
