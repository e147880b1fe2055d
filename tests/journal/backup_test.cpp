// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <thread>

#include "tests/journal/records.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

TEST(Backup, OfAJournalThatGrowsBecomesOneThatEndsAtTheBackup) {
  test::TemporaryFolder folder;
  const auto journal = test::open_journal(folder.file("data"));
  test::append_some(*journal, 1, 100);
  const Result<ContentHash> payload = journal->put_payload(std::string(50'000, 'p'));
  std::thread writer([&] { test::append_some(*journal, 101, 600); });
  EXPECT_TRUE(journal->backup(folder.file("backup")));
  writer.join();
  ASSERT_TRUE(Journal::restore(folder.file("backup"), folder.file("restored")));
  const auto restored = test::open_journal(folder.file("restored"));
  const JournalHead head = restored->head();
  EXPECT_FALSE(restored->open_report().damage);
  EXPECT_GE(head.revision.number, 100u);
  EXPECT_EQ(head.revision.store, journal->head().revision.store);
  // Record numbers above the backup's head name other records now.
  EXPECT_EQ(head.revision.era, 1u);
  EXPECT_EQ(head.chain, test::some_chain(head.revision.number).back());
  EXPECT_TRUE(restored->has_payload(*payload));
  EXPECT_TRUE(restored->verify());
  EXPECT_FALSE(Journal::restore(folder.file("backup"), folder.file("restored")));
}

TEST(Backup, ThatDoesNotExistIsNotRestored) {
  test::TemporaryFolder folder;
  EXPECT_FALSE(Journal::restore(folder.file("nothing"), folder.file("restored")));
}

}  // namespace
}  // namespace cairn
