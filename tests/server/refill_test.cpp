// SPDX-License-Identifier: BSD-3-Clause
// Stores that lost their end, filled again from clients' spools.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <mutex>

#include "clients/client/client.hpp"
#include "server/memory_transport.hpp"
#include "server/service.hpp"
#include "tests/server/drive.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;
using test::estimates;

// The store of a running client is replaced by an older one.
class RefillTest : public testing::Test {
 protected:
  static constexpr Refill::Patience kPatience{100ms, 5000ms, 20000ms};
  struct Daemon {
    Daemon(const std::filesystem::path& folder, const MemoryNetwork& network)
        : journal(*Journal::open(folder.string())),
          transport(network.make_transport()),
          service(*journal, *transport,
                  {.solve_after_pause = 20ms, .state_every = 10ms, .refill = kPatience}) {
      EXPECT_TRUE(service.start());
    }
    std::unique_ptr<Journal> journal;
    std::unique_ptr<Transport> transport;
    Service service;
  };
  Client connect(const std::string& spool) {
    Client client = *Client::connect(
        {.source = "test", .robot = "robot", .spool = folder_.path() / spool, .retry_most = 50ms},
        [this](Link::Identity identity) { return network_.make_link(std::move(identity)); });
    client.on_events([this](const Event& event) {
      const std::lock_guard lock(mutex_);
      events_.push_back(event.kind + ": " + event.text);
    });
    return client;
  }
  void submit(Client& client, std::size_t from, std::size_t to) {
    std::vector<Submission> sent;
    for (std::size_t i = from; i < to; ++i) sent.push_back(*client.submit_async(steps_[i]));
    for (const Submission& submission : sent) {
      const Result<Receipt> receipt = submission.wait(20s);
      ASSERT_TRUE(receipt) << receipt.error().to_string();
      ASSERT_FALSE(receipt->refusal) << receipt->reason;
      newest_ = receipt->revision;
    }
  }
  // Steps up to `all` are durable in "data", and those up to `kept` in "old" too, its copy.
  void leave_behind(Client& client, std::size_t kept, std::size_t all) {
    {
      const Daemon first(path("data"), network_);
      submit(client, 0, kept);
    }
    std::filesystem::copy(path("data"), path("old"), std::filesystem::copy_options::recursive);
    const Daemon second(path("data"), network_);
    submit(client, kept, all);
  }
  [[nodiscard]] std::filesystem::path path(const char* name) const { return folder_.path() / name; }
  std::vector<std::string> events() {
    const std::lock_guard lock(mutex_);
    return events_;
  }

  bool was_told(const std::string& beginning) {
    const auto told = events();
    return std::any_of(told.begin(), told.end(),
                       [&](const std::string& event) { return event.starts_with(beginning); });
  }

  test::TemporaryFolder folder_;
  MemoryNetwork network_;
  std::vector<Transaction> steps_ = test::troubled_drive(400);
  Revision newest_;
  std::mutex mutex_;
  std::vector<std::string> events_;
};

TEST_F(RefillTest, FillsAStoreThatLostItsEndInANewEra) {
  Client client = connect("spool");
  leave_behind(client, 30, 350);
  const Revision promised = newest_;
  Daemon daemon(path("old"), network_);
  submit(client, 350, 400);
  EXPECT_GT(newest_.era, promised.era);
  EXPECT_EQ(newest_.store, promised.store);
  ASSERT_TRUE(client.command("settle", 30s));
  EXPECT_EQ(estimates(*daemon.journal), test::settled_estimates(steps_));
  EXPECT_TRUE(daemon.journal->verify());
  EXPECT_TRUE(was_told("damage: the store ends at "));
  EXPECT_TRUE(was_told("refilled: "));
}

TEST_F(RefillTest, RaisesTheEraEvenWhereTheClientHasRestartedToo) {
  {
    Client client = connect("spool");
    leave_behind(client, 30, 350);
  }
  const Revision promised = newest_;
  Client client = connect("spool");
  Daemon daemon(path("old"), network_);
  submit(client, 350, 400);
  EXPECT_GT(newest_.era, promised.era);
  ASSERT_TRUE(client.command("settle", 30s));
  EXPECT_EQ(estimates(*daemon.journal), test::settled_estimates(steps_));
}

TEST_F(RefillTest, FillsABackupThatWasRestored) {
  Client client = connect("spool");
  {
    const Daemon first(path("data"), network_);
    submit(client, 0, 30);
    ASSERT_TRUE(first.journal->backup(path("backup")));
    submit(client, 30, 350);
  }
  ASSERT_TRUE(Journal::restore(path("backup"), path("restored")));
  Daemon daemon(path("restored"), network_);
  submit(client, 350, 400);
  ASSERT_TRUE(client.command("settle", 30s));
  EXPECT_EQ(estimates(*daemon.journal), test::settled_estimates(steps_));
  EXPECT_TRUE(was_told("refilled: "));
}

TEST_F(RefillTest, GoesOnWithoutAClientThatIsGone) {
  {
    Client client = connect("spool");
    leave_behind(client, 10, 300);
  }
  std::filesystem::remove_all(path("spool"));
  Daemon daemon(path("old"), network_);
  Client anew = connect("anew");
  Transaction other = steps_[0];
  other.variables[0].node.frame.robot = "another";
  const Result<Receipt> receipt = anew.submit(other, 20s);
  ASSERT_TRUE(receipt) << receipt.error().to_string();
  EXPECT_FALSE(receipt->refusal) << receipt->reason;
}

}  // namespace
}  // namespace cairn
