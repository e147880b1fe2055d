// SPDX-License-Identifier: BSD-3-Clause
// The real daemon as a process, over real DDS, in a domain of its own.
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>
#include <mutex>
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

TEST(Daemon, LeavesADomainToTheOneThatWasThereFirst) {
  const test::TemporaryFolder folder;
  Daemon first(folder.path() / "first", test::own_domain());
  Result<Client> client = Client::connect({.domain = test::own_domain(),
                                           .source = "test",
                                           .robot = "robot",
                                           .spool = folder.path() / "spool"});
  ASSERT_TRUE(client);
  const std::vector<Transaction> steps = test::drive(2);
  ASSERT_TRUE(client->submit(steps[0], 30s));
  Daemon second(folder.path() / "second", test::own_domain());
  const auto result = second.wait(10s);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->exit_code, 2);
  EXPECT_NE(result->err.find("another daemon serves this domain"), std::string::npos)
      << result->err;
  const Result<Receipt> receipt = client->submit(steps[1], 30s);
  ASSERT_TRUE(receipt) << receipt.error().to_string();
  EXPECT_EQ(first.end(SIGTERM), 0);
}

// A limit on the size of files stands for a disk that is full in the middle of a write.
TEST(Daemon, EndsWithAnErrorWhenAWriteFailsAndLosesNothing) {
  const test::TemporaryFolder folder;
  const std::string data = folder.path() / "data", domain = std::to_string(test::own_domain());
  const std::vector<Transaction> steps = test::drive(400);
  Result<Client> client = Client::connect({.domain = test::own_domain(),
                                           .source = "test",
                                           .robot = "robot",
                                           .spool = folder.path() / "spool"});
  ASSERT_TRUE(client);
  std::vector<Submission> sent;
  for (const Transaction& step : steps) sent.push_back(*client->submit_async(step));
  Process limited({"/bin/bash", "-c",
                   "ulimit -f 64; exec " CAIRND_BINARY " --data " + data + " --domain " + domain});
  const auto result = limited.wait(30s);
  ASSERT_TRUE(result) << "it goes on though nothing can be written";
  EXPECT_EQ(result->exit_code, 1) << result->err;  // no signal
  EXPECT_NE(result->err.find("File too large"), std::string::npos) << result->err;
  Daemon daemon(data, test::own_domain());
  for (const Submission& submission : sent) {
    const Result<Receipt> receipt = submission.wait(60s);
    ASSERT_TRUE(receipt) << receipt.error().to_string();
    EXPECT_FALSE(receipt->refusal) << receipt->reason;
  }
  ASSERT_TRUE(client->command("settle", 60s));
  EXPECT_EQ(daemon.end(SIGTERM), 0);
  const auto journal = Journal::open(data);
  ASSERT_TRUE(journal);
  EXPECT_EQ(test::estimates(**journal), test::settled_estimates(steps));
}

// A byte in the middle of the store's log is not what it was: after a kill, and behind the snapshot
// of estimates that a good end leaves.
class DamagedDaemon : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(After, DamagedDaemon, testing::Values(SIGKILL, SIGTERM),
                         [](const auto& ending) {
                           return ending.param == SIGKILL ? "Kill" : "GoodEnd";
                         });

TEST_P(DamagedDaemon, ServesTheGoodBeginningAndIsRefilledByItsClients) {
  const test::TemporaryFolder folder;
  const std::vector<Transaction> steps = test::drive(300);
  Daemon daemon(folder.path() / "data", test::own_domain());
  Result<Client> client = Client::connect({.domain = test::own_domain(),
                                           .source = "test",
                                           .robot = "robot",
                                           .spool = folder.path() / "spool"});
  ASSERT_TRUE(client);
  std::mutex mutex;
  std::string attention;
  client->on_status([&](const Status& status) {
    const std::lock_guard lock(mutex);
    attention = status.message;
  });
  std::vector<Submission> sent;
  for (std::size_t i = 0; i + 1 < steps.size(); ++i)
    sent.push_back(*client->submit_async(steps[i]));
  for (const Submission& submission : sent) ASSERT_TRUE(submission.wait(30s));
  const Result<Receipt> before = sent.back().wait(1s);
  ASSERT_TRUE(client->command("settle", 60s));
  daemon.end(GetParam());
  EXPECT_EQ(std::filesystem::exists(folder.path() / "data" / "snapshots"), GetParam() == SIGTERM);

  std::filesystem::path log;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "data" / "store")) {
    if (entry.path().extension() == ".log" && (log.empty() || entry.file_size() > file_size(log)))
      log = entry.path();
  }
  ASSERT_FALSE(log.empty());
  std::fstream file(log, std::ios::in | std::ios::out | std::ios::binary);
  const auto middle = static_cast<std::streamoff>(file_size(log) / 2);
  file.seekg(middle);
  const int byte = file.get();
  file.seekp(middle);
  file.put(static_cast<char>(byte ^ 0x40));
  file.close();

  daemon.start();
  const Result<Receipt> after = client->submit(steps.back(), 60s);
  ASSERT_TRUE(after) << after.error().to_string();
  EXPECT_FALSE(after->refusal) << after->reason;
  EXPECT_GT(after->revision.era, before->revision.era);
  ASSERT_TRUE(client->command("settle", 60s));
  {
    const std::lock_guard lock(mutex);
    EXPECT_TRUE(attention.starts_with("the store was damaged: ")) << attention;
    EXPECT_NE(attention.find(log.filename()), std::string::npos) << attention;
  }
  EXPECT_EQ(daemon.end(SIGTERM), 0);
  const auto journal = Journal::open((folder.path() / "data").string());
  ASSERT_TRUE(journal);
  EXPECT_EQ(test::estimates(**journal), test::settled_estimates(steps));
}

TEST(Daemon, SaysWhatToDoWhereItsFolderCannotBeWritten) {
  const test::TemporaryFolder folder;
  Daemon daemon("/proc/cairn", test::own_domain());  // root may write anywhere else
  const auto result = daemon.wait(10s);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->exit_code, 1);
  EXPECT_NE(result->err.find("/proc/cairn"), std::string::npos) << result->err;
}

}  // namespace
}  // namespace cairn
