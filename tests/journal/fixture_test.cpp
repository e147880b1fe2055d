// SPDX-License-Identifier: BSD-3-Clause
// Records of version 1 as they were written once. They must be read for ever.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "tests/journal/records.hpp"
#include "tests/support/process.hpp"

namespace cairn {
namespace {

std::string from_hex(const std::string& digits) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2)
    bytes += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  return bytes;
}

TEST(StoredRecords, OfVersionOneAreReadAndContinueTheirChain) {
  std::ifstream file(std::string(CAIRN_SOURCE_DIR) + "/tests/journal/fixtures/records_1.hex");
  ContentHash chain{};
  std::uint64_t number = 0;
  for (std::string line; std::getline(file, line);) {
    const std::string bytes = from_hex(line);
    const Result<Record> record = decode_record(bytes);
    ASSERT_TRUE(record) << record.error().to_string();
    EXPECT_EQ(record->number, ++number);
    EXPECT_EQ(record->kind(), static_cast<RecordKind>(test::some_record(number).index() + 1));
    chain = chain_after(chain, bytes);
    EXPECT_EQ(record->chain, chain);
    EXPECT_EQ(encode_record(number, 0, test::some_record(number),
                            number == 1 ? ContentHash{} : test::some_chain(number - 1).back()),
              bytes);
  }
  EXPECT_EQ(number, 20u);
  EXPECT_EQ(to_string(chain), "a83b4cda14b12c6f31c2fb93df0da0b4220413705f85282bc9d1f774df2359ad");
}

constexpr std::uint64_t kRecords = 300;

// How the stored folder was made; with CAIRN_WRITE_FIXTURE it is made again, there.
TEST(StoredFolder, CanBeMadeAgain) {
  const test::TemporaryFolder folder;
  const char* given = std::getenv("CAIRN_WRITE_FIXTURE");
  const std::string data = given ? given : folder.file("data");
  JournalOptions options;
  options.write_buffer_bytes = 64u << 10;  // tables as well as logs
  {
    const auto journal = test::open_journal(data, options);
    test::append_some(*journal, 1, kRecords / 2);
    ASSERT_TRUE(journal->put_payload(std::string(5000, 's')));
    ASSERT_TRUE(journal->write_snapshot(kRecords / 2, "estimates"));
  }
  const auto journal = test::open_journal(data, options);
  test::append_some(*journal, kRecords / 2 + 1, kRecords);
  EXPECT_EQ(journal->head().chain, test::some_chain(kRecords).back());
}

// A data folder of format 1, written by Cairn 0.1.0. Every later version must open it.
TEST(StoredFolder, OfFormatOneIsOpenedWholeAndGoesOn) {
  const test::TemporaryFolder folder;
  const std::string archive = CAIRN_SOURCE_DIR "/tests/journal/fixtures/data_folder_1.tar.gz";
  const test::ProcessResult unpacked =
      test::Process({"/bin/tar", "xzf", archive, "-C", folder.path()}).wait();
  ASSERT_EQ(unpacked.exit_code, 0) << unpacked.err;
  const std::string data = folder.file("data_folder_1");
  {
    const auto journal = test::open_journal(data);
    EXPECT_FALSE(journal->open_report().created);
    EXPECT_FALSE(journal->open_report().damage);
    EXPECT_EQ(journal->head().revision.number, kRecords);
    EXPECT_EQ(journal->head().revision.era, 0U);
    EXPECT_EQ(journal->head().chain, test::some_chain(kRecords).back());
    const auto payload = journal->read_payload(content_hash(std::string(5000, 's')));
    ASSERT_TRUE(payload) << payload.error().to_string();
    EXPECT_EQ(payload->size(), 5000U);
    ASSERT_TRUE(journal->newest_snapshot());
    EXPECT_EQ(journal->newest_snapshot()->bytes, "estimates");
    const auto sound = journal->verify();
    EXPECT_TRUE(sound) << sound.error().to_string();
    EXPECT_TRUE(journal->append(test::some_records(kRecords + 1, kRecords + 1)));
  }
  EXPECT_EQ(test::open_journal(data)->head().chain, test::some_chain(kRecords + 1).back());
}

}  // namespace
}  // namespace cairn
