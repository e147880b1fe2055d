// SPDX-License-Identifier: BSD-3-Clause
// The example of backend/journal/README.md, word for word.
#include <gtest/gtest.h>

#include "tests/journal/records.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

Result<void> count_transactions(const std::string& folder, int& count) {
  Result<std::unique_ptr<Journal>> journal = Journal::open(folder);
  if (!journal) return journal.error();
  const RecordBody order = CommandRecord{"anna", "before the demo", "freeze", 0};
  const Result<Revision> revision = (*journal)->append({&order, 1});
  if (!revision) return revision.error();
  return (*journal)->for_each(1, [&](const Record& record) -> Result<void> {
    count += record.kind() == RecordKind::kTransaction;
    return {};
  });
}

TEST(JournalReadme, ExampleCountsTransactions) {
  test::TemporaryFolder folder;
  { test::append_some(*test::open_journal(folder.file("data")), 1, 4); }
  int count = 0;
  ASSERT_TRUE(count_transactions(folder.file("data"), count));
  EXPECT_EQ(count, 4);
}

}  // namespace
}  // namespace cairn
