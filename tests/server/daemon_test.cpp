// SPDX-License-Identifier: BSD-3-Clause
// The real daemon as a process, over real DDS, in a domain of its own.
#include <gtest/gtest.h>

#include <random>

#include "clients/client/client.hpp"
#include "tests/server/drive.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/process.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;
using test::Process;

class Daemon {
 public:
  Daemon(std::filesystem::path folder, std::uint32_t domain)
      : folder_(std::move(folder)), domain_(domain) {
    start();
  }

  void start() {
    process_ = Process({CAIRND_BINARY, "--data", folder_, "--domain", std::to_string(domain_)});
  }
  /// Its exit code.
  int end(int signal_number) { return process_.end(signal_number).exit_code; }
  std::optional<test::ProcessResult> wait(std::chrono::milliseconds timeout) {
    return process_.wait(timeout);
  }

 private:
  std::filesystem::path folder_;
  std::uint32_t domain_;
  Process process_;
};

TEST(Daemon, LosesAndDoublesNothingWhenItIsKilledAgainAndAgain) {
  const test::TemporaryFolder folder;
  const std::uint32_t seed = std::random_device{}();
  std::mt19937 random(seed);
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  const std::vector<Transaction> steps = test::drive(600);
  Daemon daemon(folder.path() / "data", test::own_domain());
  {
    Result<Client> client = Client::connect({.domain = test::own_domain(),
                                             .source = "test",
                                             .robot = "robot",
                                             .spool = folder.path() / "spool"});
    ASSERT_TRUE(client) << client.error().to_string();
    std::vector<Submission> sent;
    std::size_t next = 0;
    for (int kills = 0; kills < 6; ++kills) {
      for (std::size_t end = std::min(steps.size(), next + 100); next < end; ++next) {
        Result<Submission> taken = client->submit_async(steps[next]);
        ASSERT_TRUE(taken) << taken.error().to_string();
        sent.push_back(*taken);
      }
      // In the middle of it: some of these are receipted, some written, some on their way.
      ASSERT_TRUE(sent[sent.size() - 1 - random() % 90].wait(60s));
      daemon.end(SIGKILL);
      daemon.start();
    }
    ASSERT_EQ(sent.size(), steps.size());
    for (const Submission& submission : sent) {
      const Result<Receipt> receipt = submission.wait(60s);
      ASSERT_TRUE(receipt) << receipt.error().to_string();
      ASSERT_FALSE(receipt->refusal) << receipt->reason;
    }
    ASSERT_TRUE(client->command("settle", 60s));
  }
  EXPECT_EQ(daemon.end(SIGTERM), 0);

  const auto journal = Journal::open((folder.path() / "data").string());
  ASSERT_TRUE(journal) << journal.error().to_string();
  EXPECT_TRUE((*journal)->verify());
  std::uint64_t expected = 0;
  ASSERT_TRUE((*journal)->for_each(1, [&](const Record& record) -> Result<void> {
    if (const auto* transaction = std::get_if<TransactionRecord>(&record.body)) {
      EXPECT_EQ(transaction->key().sequence, ++expected);
    }
    return {};
  }));
  EXPECT_EQ(expected, steps.size());
  EXPECT_EQ(test::estimates(**journal), test::settled_estimates(steps));
}

TEST(Daemon, RefusesAFolderThatAnotherOneServes) {
  const test::TemporaryFolder folder;
  const auto journal = Journal::open((folder.path() / "data").string());
  ASSERT_TRUE(journal);
  Daemon second(folder.path() / "data", test::own_domain());
  const auto result = second.wait(5s);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->exit_code, 2);
  EXPECT_NE(result->err.find("the data folder is in use by process"), std::string::npos)
      << result->err;
}

}  // namespace
}  // namespace cairn
