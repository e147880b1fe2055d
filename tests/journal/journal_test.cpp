// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/journal/journal.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "cairn/core/wall_clock.hpp"
#include "tests/journal/records.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

using test::append_some;
using test::open_journal;
using test::some_chain;
using test::TemporaryFolder;

TEST(Journal, StartsEmptyWithAStoreOfItsOwn) {
  TemporaryFolder a, b;
  const auto one = open_journal(a.file("data")), other = open_journal(b.file("data"));
  EXPECT_TRUE(one->open_report().created);
  EXPECT_EQ(one->head().revision.number, 0u);
  EXPECT_NE(one->head().revision.store, other->head().revision.store);
  EXPECT_TRUE(one->verify());
}

TEST(Journal, HasTheSameRevisionAndHashAfterEachRestart) {
  TemporaryFolder folder;
  const std::vector<ContentHash> chain = some_chain(100);
  Revision before;
  for (std::uint64_t start = 1; start <= 100; start += 20) {
    const auto journal = open_journal(folder.file("data"));
    EXPECT_FALSE(journal->open_report().damage || journal->open_report().cut_tail);
    if (start > 1) {
      EXPECT_EQ(journal->head().revision, before);
    }
    EXPECT_EQ(journal->head().chain, chain[start - 1]);
    append_some(*journal, start, start + 19);
    before = journal->head().revision;
    EXPECT_EQ(before.number, start + 19);
  }
}

TEST(Journal, VisitsItsRecordsInOrderFromAnyNumber) {
  TemporaryFolder folder;
  const auto journal = open_journal(folder.file("data"));
  append_some(*journal, 1, 50);
  for (const std::uint64_t from : {1, 2, 30, 50, 51}) {
    std::uint64_t expected = from;
    const Result<void> done = journal->for_each(from, [&](const Record& record) -> Result<void> {
      EXPECT_EQ(record.number, expected);
      EXPECT_EQ(record.body.index(), test::some_record(expected).index());
      ++expected;
      return {};
    });
    EXPECT_TRUE(done);
    EXPECT_EQ(expected, 51u);
  }
  EXPECT_EQ(journal->read(9)->kind(), RecordKind::kVerdict);
  EXPECT_FALSE(journal->read(51));
}

TEST(Journal, PassesOnTheErrorOfAVisitor) {
  TemporaryFolder folder;
  const auto journal = open_journal(folder.file("data"));
  append_some(*journal, 1, 5);
  const Result<void> done = journal->for_each(1, [](const Record&) -> Result<void> {
    return Error{ErrorCode::kNotUsable, "enough"};
  });
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().message, "enough");
}

TEST(Journal, IsOpenInOnePlaceAtATime) {
  TemporaryFolder folder;
  auto journal = open_journal(folder.file("data"));
  const auto second = Journal::open(folder.file("data"));
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message.find("process " + std::to_string(::getpid())), std::string::npos)
      << second.error().to_string();
  journal.reset();
  EXPECT_TRUE(Journal::open(folder.file("data")));
}

TEST(Journal, OfANewerFormatIsRefusedUntouched) {
  TemporaryFolder folder;
  { append_some(*open_journal(folder.file("data")), 1, 5); }
  const std::string newer = "cairn store format 2\nid 0000000000000001\nera 0\nend\n";
  (void)folder.write("data/STORE", newer);
  const auto files = [&] {
    std::string all;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.file("data")))
      all += entry.path().string() + test::read_file(entry.path());
    return all;
  };
  const std::string before = files();
  const auto journal = Journal::open(folder.file("data"));
  ASSERT_FALSE(journal);
  EXPECT_NE(journal.error().message.find("format 2"), std::string::npos);
  EXPECT_EQ(files(), before);
}

TEST(Journal, RaisesItsEraForWhatFollows) {
  TemporaryFolder folder;
  {
    const auto journal = open_journal(folder.file("data"));
    append_some(*journal, 1, 5);
    ASSERT_TRUE(journal->raise_era());
    append_some(*journal, 6, 10);
  }
  const auto journal = open_journal(folder.file("data"));
  EXPECT_EQ(journal->head().revision.era, 1u);
  EXPECT_EQ(journal->read(5)->era, 0u);
  EXPECT_EQ(journal->read(6)->era, 1u);
}

TEST(Journal, StopsAtAFullDiskAndResumes) {
  TemporaryFolder folder;
  std::filesystem::space_info disk{.capacity = 1000, .free = 500, .available = 500};
  JournalOptions options;
  options.measure_space = [&](const std::string&) { return disk; };
  const auto journal = open_journal(folder.file("data"), options);
  EXPECT_EQ(journal->space(), DiskSpace::kPlenty);
  disk.available = 99;
  EXPECT_EQ(journal->space(), DiskSpace::kLow);
  append_some(*journal, 1, 5);
  disk.available = 19;
  EXPECT_EQ(journal->space(), DiskSpace::kFull);
  const auto refused = journal->append(test::some_records(6, 6));
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("storage full"), std::string::npos);
  EXPECT_FALSE(journal->put_payload("scan"));
  EXPECT_FALSE(journal->failed());
  disk.available = 200;
  append_some(*journal, 6, 10);
  EXPECT_EQ(journal->head().chain, some_chain(10)[10]);
}

TEST(Payloads, AreFoundByTheirHash) {
  TemporaryFolder folder;
  ContentHash small, large;
  {
    const auto journal = open_journal(folder.file("data"));
    small = *journal->put_payload("scan");
    large = *journal->put_payload(std::string(100'000, 'x'));
    EXPECT_EQ(*journal->put_payload("scan"), small);
  }
  const auto journal = open_journal(folder.file("data"));
  EXPECT_EQ(*journal->read_payload(small), "scan");
  EXPECT_EQ(journal->read_payload(large)->size(), 100'000u);
  EXPECT_TRUE(journal->verify());
}

TEST(Payloads, ThatNoTransactionNamesAreCollectedOnceTheyAreOld) {
  TemporaryFolder folder;
  const auto journal = open_journal(folder.file("data"));
  const ContentHash named = *journal->put_payload("a scan that became a factor");
  const ContentHash refused = *journal->put_payload("a scan of a refused transaction");
  const ContentHash unnamed = *journal->put_payload(std::string(100'000, 'x'));
  Transaction accepted = test::some_transaction(1);
  ASSERT_FALSE(accepted.factors.empty());
  accepted.factors[0].payloads = {named};
  const std::vector<RecordBody> records{
      TransactionRecord{accepted, {}, 0},
      TransactionRecord{
          RefusedTransaction{test::some_transaction(2).key, RefusalCode::kConflict, "why"}, {}, 0}};
  ASSERT_TRUE(journal->append(records));

  const auto go_on = [] { return true; };
  const std::int64_t before_all = wall_clock_ns() - std::int64_t{3'600'000'000'000};
  EXPECT_EQ(*journal->collect_payloads(before_all, go_on), 0u);
  const std::int64_t after_all = wall_clock_ns() + 1;
  EXPECT_FALSE(journal->collect_payloads(after_all, [] { return false; })) << "was told to stop";
  EXPECT_TRUE(journal->has_payload(unnamed));
  EXPECT_EQ(*journal->collect_payloads(after_all, go_on), 2u);
  EXPECT_TRUE(journal->has_payload(named));
  EXPECT_FALSE(journal->has_payload(refused));
  EXPECT_FALSE(journal->has_payload(unnamed));
  EXPECT_EQ(*journal->collect_payloads(after_all, [] { return false; }), 0u)
      << "what is known to be named is not looked for again";
  EXPECT_TRUE(journal->verify());
}

TEST(Payloads, StoredAgainCountAsNew) {
  TemporaryFolder folder;
  const auto journal = open_journal(folder.file("data"));
  const ContentHash hash = *journal->put_payload("scan");
  const std::int64_t between = wall_clock_ns() + 1;
  while (wall_clock_ns() <= between) {
  }
  ASSERT_TRUE(journal->put_payload("scan"));
  EXPECT_EQ(*journal->collect_payloads(between, [] { return true; }), 0u);
  EXPECT_TRUE(journal->has_payload(hash));
}

TEST(Snapshots, AreKeptTwoAndTheNewestWholeOneIsFound) {
  TemporaryFolder folder;
  auto journal = open_journal(folder.file("data"));
  EXPECT_FALSE(journal->newest_snapshot());
  append_some(*journal, 1, 30);
  for (const std::uint64_t n : {10, 20, 30}) {
    ASSERT_TRUE(journal->write_snapshot(n, "estimates " + std::to_string(n)));
  }
  EXPECT_FALSE(journal->write_snapshot(31, "of a record that does not exist"));
  EXPECT_EQ(journal->newest_snapshot()->bytes, "estimates 30");
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder.file("data/snapshots")))
    files.push_back(entry.path());
  ASSERT_EQ(files.size(), 2u);
  std::sort(files.begin(), files.end());
  std::filesystem::resize_file(files[1], 50);
  EXPECT_EQ(journal->newest_snapshot()->number, 20u);
  journal.reset();
  journal = open_journal(folder.file("data"));
  EXPECT_EQ(journal->newest_snapshot()->bytes, "estimates 20");
  EXPECT_EQ(journal->head().revision.number, 30u);
}

TEST(Journal, IsReadWhileItGrows) {
  TemporaryFolder folder;
  JournalOptions options;
  options.write_buffer_bytes = 64u << 10;  // tables are written and merged meanwhile
  const auto journal = open_journal(folder.file("data"), options);
  std::thread writer([&] { append_some(*journal, 1, 2000, 25); });
  std::uint64_t seen = 0;
  while (seen < 2000) {
    const Result<void> done =
        journal->for_each(seen + 1, [&](const Record& record) -> Result<void> {
          EXPECT_EQ(record.number, ++seen);
          return {};
        });
    if (!done) ADD_FAILURE() << done.error().to_string();
    if (!done) break;
  }
  writer.join();
  EXPECT_TRUE(journal->verify());
}

}  // namespace
}  // namespace cairn
