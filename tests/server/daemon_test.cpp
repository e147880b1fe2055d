// SPDX-License-Identifier: BSD-3-Clause
// The real daemon as a process, over real DDS, in a domain of its own.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <random>
#include <thread>

#include "clients/client/client.hpp"
#include "tests/client/temporary_folder.hpp"
#include "tests/server/drive.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;

class Daemon {
 public:
  Daemon(std::filesystem::path folder, std::uint32_t domain)
      : folder_(std::move(folder)), domain_(domain) {
    start();
  }
  ~Daemon() { end(SIGKILL); }

  void start() {
    process_ = fork();
    if (process_ != 0) return;
    const std::string domain = std::to_string(domain_);
    execl(CAIRND_BINARY, CAIRND_BINARY, "--data", folder_.c_str(), "--domain", domain.c_str(),
          nullptr);
    _exit(127);
  }
  /// Its wait status.
  int end(int signal_number) {
    if (process_ <= 0) return 0;
    kill(process_, signal_number);
    int status = 0;
    waitpid(process_, &status, 0);
    process_ = 0;
    return status;
  }

 private:
  std::filesystem::path folder_;
  std::uint32_t domain_;
  pid_t process_ = 0;
};

std::uint32_t own_domain() { return 100 + static_cast<std::uint32_t>(getpid()) % 100; }

TEST(Daemon, LosesAndDoublesNothingWhenItIsKilledAgainAndAgain) {
  const test::TemporaryFolder folder;
  const std::uint32_t seed = std::random_device{}();
  std::mt19937 random(seed);
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  const std::vector<Transaction> steps = test::drive(600);
  Daemon daemon(folder.path() / "data", own_domain());
  {
    Result<Client> client = Client::connect({.domain = own_domain(),
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
  Daemon second(folder.path() / "data", own_domain());
  int status = 0;
  for (int i = 0; i < 500 && waitpid(-1, &status, WNOHANG) == 0; ++i)
    std::this_thread::sleep_for(10ms);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_NE(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace cairn
