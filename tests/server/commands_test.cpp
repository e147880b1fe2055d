// SPDX-License-Identifier: BSD-3-Clause
#include "server/commands.hpp"

#include <gtest/gtest.h>

#include <future>

#include "cairn/journal/journal.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;

// Keeps replies; everything else a desk does not send.
class Replies final : public Transport {
 public:
  Result<void> start(TransportListener& /*listener*/) override { return {}; }
  void stop() noexcept override {}
  void publish_receipts(const std::vector<Receipt>& /*receipts*/) override {}
  void publish(const SourceState& /*state*/) override {}
  void forget(const std::string& /*source*/, std::uint64_t /*epoch*/) override {}
  void publish(const PayloadReceipt& /*receipt*/) override {}
  void publish_poses(const EstimateRevisions& /*revisions*/,
                     const std::vector<PoseChunk>& /*chunks*/) override {}
  void publish_landmarks(const EstimateRevisions& /*revisions*/,
                         const std::vector<LandmarkChunk>& /*chunks*/) override {}
  void publish(const Correction& /*correction*/) override {}
  void publish_tile_index(const std::vector<TileBlock>& /*blocks*/) override {}
  void publish(const TileAnswer& /*answer*/) override {}
  void publish(const Status& /*status*/) override {}
  void publish(const Event& /*event*/) override {}
  void reply(const Reply& reply) override {
    const std::lock_guard lock(mutex_);
    replies_.push_back(reply);
    arrived_.notify_all();
  }
  std::vector<Reply> wait_for(std::size_t count) {
    std::unique_lock lock(mutex_);
    arrived_.wait_for(lock, 20s, [&] { return replies_.size() >= count; });
    return replies_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::vector<Reply> replies_;
};

struct Office {
  Office() : journal(*Journal::open((folder.path() / "data").string())) {
    for (std::uint64_t i = 0; i < 5; ++i) {
      const RecordBody order = CommandRecord{"anna", "", "order " + std::to_string(i), 0};
      EXPECT_TRUE(journal->append({&order, 1}));
    }
  }
  test::TemporaryFolder folder;
  std::unique_ptr<Journal> journal;
  Replies replies;
  CommandDesk desk{*journal, replies};
};

TEST(CommandDesk, AnswersInOrderAndSaysErrors) {
  Office office;
  office.desk.take({{1, 1}, "log {\"from\":5}"}, {});
  office.desk.take({{1, 2}, "show {\"number\":77}"}, {});
  office.desk.take({{1, 3}, "log {\"form\":5}"}, {});
  office.desk.take({{1, 4}, "log [nonsense"}, {});
  office.desk.take({{1, 5}, "log {nonsense"}, {});
  const auto replies = office.replies.wait_for(5);
  ASSERT_EQ(replies.size(), 5u);
  EXPECT_FALSE(replies[0].error);
  EXPECT_NE(replies[0].text.find("anna: order 4"), std::string::npos) << replies[0].text;
  EXPECT_EQ(replies[1].text, "there is no record 77; expected one of 1 to 5");
  EXPECT_TRUE(replies[2].text.starts_with("log has no option 'form'"));
  for (std::size_t i = 1; i < 5; ++i) EXPECT_EQ(replies[i].error, ErrorCode::kUsage) << i;
}

TEST(CommandDesk, SaysTheSameToARepeatedQuestion) {
  Office office;
  const std::string folder = (office.folder.path() / "backups").string();
  const Command command{{1, 1}, "backup {\"folder\":\"" + folder + "\"}"};
  office.desk.take(command, {});
  ASSERT_EQ(office.replies.wait_for(1).size(), 1u);
  office.desk.take(command, {});
  const auto replies = office.replies.wait_for(2);
  ASSERT_EQ(replies.size(), 2u);
  EXPECT_EQ(replies[0].text, replies[1].text);
  EXPECT_FALSE(replies[0].error) << replies[0].text;
  // One backup, and not two.
  const auto backups = std::filesystem::directory_iterator(folder + "/meta");
  EXPECT_EQ(std::distance(begin(backups), end(backups)), 1);
}

TEST(CommandDesk, BacksUpToAbsolutePathsOnly) {
  Office office;
  office.desk.take({{1, 1}, "backup {\"folder\":\"here\"}"}, {});
  EXPECT_EQ(office.replies.wait_for(1).front().error, ErrorCode::kUsage);
}

TEST(CommandDesk, TakesABoundedNumberOfQuestions) {
  Office office;
  for (std::uint64_t i = 0; i < 1000; ++i) office.desk.take({{1, i}, "log {}"}, {});
  const auto replies = office.replies.wait_for(1000);
  EXPECT_EQ(replies.size(), 1000u) << "each is answered, if only with: later";
  EXPECT_TRUE(office.desk.stop(2s));
}

}  // namespace
}  // namespace cairn
