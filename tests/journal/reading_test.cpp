// SPDX-License-Identifier: BSD-3-Clause
// Opening for reading only: everything is seen and told, and no file changes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <random>

#include "tests/journal/recorded_disk.hpp"
#include "tests/journal/records.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr std::uint64_t kRecords = 200;
constexpr std::uint64_t kGroup = 4;

JournalOptions reading() {
  JournalOptions options;
  options.read_only = true;
  return options;
}

// Every file below a folder, with its bytes.
std::map<std::string, std::string> content(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    files[entry.path().string()] =
        entry.is_regular_file() ? test::read_file(entry.path().string()) : "";
  return files;
}

class Reading : public testing::Test {
 protected:
  void SetUp() override {
    JournalOptions options;
    options.file_system = test::unsynced_file_system();
    options.write_buffer_bytes = 64u << 10;
    const auto journal = test::open_journal(data(), options);
    for (std::uint64_t n = 1; n <= kRecords; n += 20) {
      test::append_some(*journal, n, n + 19, kGroup);
      ASSERT_TRUE(journal->put_payload(std::string(8000 + n, 'x')));
    }
    head_ = journal->head();
  }
  [[nodiscard]] std::string data() const { return folder_.file("data"); }

  test::TemporaryFolder folder_;
  JournalHead head_;
};

TEST_F(Reading, SeesEverythingAndChangesNothing) {
  const auto before = content(data());
  {
    const auto journal = Journal::open(data(), reading());
    ASSERT_TRUE(journal) << journal.error().to_string();
    EXPECT_EQ((*journal)->head(), head_);
    EXPECT_TRUE((*journal)->verify());
    const auto appended = (*journal)->append(test::some_records(1, 1));
    ASSERT_FALSE(appended);
    EXPECT_THAT(appended.error().message, HasSubstr("reading only"));
  }
  EXPECT_EQ(content(data()), before);
}

TEST_F(Reading, KeepsWritersOutAndLetsReadersIn) {
  auto first = Journal::open(data(), reading());
  auto second = Journal::open(data(), reading());
  ASSERT_TRUE(first);
  ASSERT_TRUE(second) << second.error().to_string();
  const auto writer = Journal::open(data());
  ASSERT_FALSE(writer);
  EXPECT_THAT(writer.error().message, HasSubstr("is being read"));
  first->reset();
  second->reset();
  const auto next = Journal::open(data());
  ASSERT_TRUE(next);
  const auto late = Journal::open(data(), reading());
  ASSERT_FALSE(late);
  EXPECT_THAT(late.error().message, HasSubstr("in use by process"));
}

TEST_F(Reading, NeedsAJournalAndMakesNone) {
  const std::string empty = folder_.file("empty");
  fs::create_directory(empty);
  for (const std::string& place : {empty, folder_.file("nowhere")}) {
    const auto journal = Journal::open(place, reading());
    ASSERT_FALSE(journal);
    EXPECT_THAT(journal.error().message, HasSubstr("no journal here"));
  }
  EXPECT_TRUE(fs::is_empty(empty));
  EXPECT_FALSE(fs::exists(folder_.file("nowhere")));
}

TEST_F(Reading, TellsAWriteThatNeverFinished) {
  std::string log;
  for (const auto& entry : fs::directory_iterator(data() + "/store")) {
    if (entry.path().extension() == ".log" && entry.file_size() > 0)
      log = std::max(log, entry.path().string());  // the newest
  }
  ASSERT_FALSE(log.empty());
  fs::resize_file(log, fs::file_size(log) - 3);
  const auto before = content(data());
  {
    const auto journal = Journal::open(data(), reading());
    ASSERT_TRUE(journal) << journal.error().to_string();
    EXPECT_TRUE((*journal)->open_report().cut_tail);
    EXPECT_LT((*journal)->head().revision.number, kRecords + 1);
    EXPECT_TRUE((*journal)->verify());
  }
  EXPECT_EQ(content(data()), before);
}

// What a power failure leaves of an append to the MANIFEST.
TEST_F(Reading, TellsAWriteToTheManifestThatNeverFinished) {
  std::string manifest;
  for (const auto& entry : fs::directory_iterator(data() + "/store")) {
    if (entry.path().filename().string().rfind("MANIFEST-", 0) == 0)
      manifest = std::max(manifest, entry.path().string());
  }
  const std::string whole = test::read_file(manifest);
  const std::string header("\x11\x22\x33\x44\x32\x00\x01", 7);
  for (const std::string& tail : {header + std::string(60, '\0'), header}) {
    std::ofstream(manifest, std::ios::binary) << whole << tail;
    const auto before = content(data());
    {
      const auto journal = Journal::open(data(), reading());
      ASSERT_TRUE(journal) << journal.error().to_string();
      EXPECT_EQ((*journal)->head(), head_);
      EXPECT_TRUE((*journal)->verify());
    }
    EXPECT_EQ(content(data()), before);
  }
}

// What opening for writing finds, opening for reading (with verify) finds too.
TEST_F(Reading, FindsDamageOfEveryFileAndLeavesItAsItIs) {
  std::mt19937 random(9);
  std::size_t found = 0;
  for (const auto& [file, bytes] : content(data() + "/store")) {
    const std::string name = fs::path(file).filename().string();
    if (bytes.empty() || name.rfind("LOG", 0) == 0 || name.rfind("OPTIONS", 0) == 0 ||
        name == "IDENTITY")
      continue;
    for (int i = 0; i < 6; ++i) {
      std::string broken = bytes;
      const std::size_t at = random() % bytes.size();
      if (i < 4)
        broken[at] = static_cast<char>(broken[at] ^ 1 << random() % 8);
      else
        broken.resize(at);
      std::ofstream(file, std::ios::binary) << broken;
      const auto before = content(data());
      std::string told;
      {
        const auto journal = Journal::open(data(), reading());
        const Result<void> sound = journal ? (*journal)->verify() : Result<void>(journal.error());
        if (!sound) told = sound.error().to_string();
        if (journal && (*journal)->open_report().cut_tail)
          told = *(*journal)->open_report().cut_tail;
        if (journal && told.empty() && !name.ends_with(".log")) {
          EXPECT_EQ((*journal)->head(), head_) << name << " byte " << at;
        }
      }
      found += !told.empty();
      EXPECT_EQ(content(data()), before) << name;
    }
    std::ofstream(file, std::ios::binary) << bytes;
  }
  EXPECT_GT(found, 15u);
}

}  // namespace
}  // namespace cairn
