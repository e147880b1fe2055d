// SPDX-License-Identifier: BSD-3-Clause
// Broken disks: whatever happens to the files, opening gives a good beginning of the journal, says
// what it lost, and keeps the damaged files.
#include <gtest/gtest.h>
#include <rocksdb/file_system.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>
#include <random>

#include "tests/journal/recorded_disk.hpp"
#include "tests/journal/records.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kRecords = 400;
constexpr std::uint64_t kLargestGroup = 7;

// A journal with table, blob and log files, and what is in it.
class Damage : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    original_ = std::make_unique<test::TemporaryFolder>();
    chain_ = test::some_chain(kRecords);
    JournalOptions options = quick();
    options.write_buffer_bytes = 64u << 10;
    const auto journal = test::open_journal(original_->file("data"), options);
    for (std::uint64_t n = 1; n <= kRecords; n += 20) {
      test::append_some(*journal, n, n + 19, kLargestGroup);
      ASSERT_TRUE(journal->put_payload(std::string(8000 + n, 'x')));
    }
  }
  static void TearDownTestSuite() { original_.reset(); }

  static JournalOptions quick() {
    JournalOptions options;
    options.file_system = test::unsynced_file_system();
    return options;
  }

  // The newest file of the store whose name fits.
  static std::string store_file(const std::string& part) {
    std::string found;
    for (const auto& entry : fs::directory_iterator(original_->file("data/store"))) {
      const std::string name = entry.path().filename().string();
      if (name.find(part) != std::string::npos && entry.file_size() > 0 && name > found)
        found = name;
    }
    EXPECT_FALSE(found.empty()) << part;
    return found;
  }

  // What is served after `change` was done to a copy of a file of the store.
  std::uint64_t head_after(const std::string& file, const std::function<void(std::string&)>& change,
                           bool& reported) {
    const std::string copy = folder_.file("copy");
    fs::remove_all(copy);
    fs::copy(original_->file("data"), copy, fs::copy_options::recursive);
    std::string bytes = test::read_file(copy + "/store/" + file);
    change(bytes);
    std::ofstream(copy + "/store/" + file, std::ios::binary) << bytes;
    const auto journal = Journal::open(copy, quick());
    EXPECT_TRUE(journal) << file << ": " << (journal ? "" : journal.error().to_string());
    if (!journal) return 0;
    const JournalHead head = (*journal)->head();
    const auto& damage = (*journal)->open_report().damage;
    reported = damage.has_value();
    told_ = damage ? damage->what : "no damage reported";
    EXPECT_LE(head.revision.number, kRecords);
    EXPECT_EQ(head.chain, chain_[head.revision.number]) << file;
    EXPECT_EQ(head.revision.era, reported ? 1u : 0u);
    if (damage) {
      EXPECT_EQ(damage->kept, head.revision.number);
      EXPECT_TRUE(fs::exists(damage->set_aside + "/" + file)) << "not set aside: " << file;
      EXPECT_FALSE(damage->what.empty());
    }
    EXPECT_TRUE((*journal)->append(test::some_records(1, 3)));
    EXPECT_TRUE((*journal)->verify() || !damage) << file;
    return head.revision.number;
  }

  void flip_bits(const std::string& file, int times, std::uint64_t at_least) {
    std::mt19937 random(5);
    const std::uint64_t size = fs::file_size(original_->file("data/store/" + file));
    for (int i = 0; i < times; ++i) {
      const std::uint64_t at = random() % size;
      bool reported = false;
      const std::uint64_t head = head_after(
          file,
          [&](std::string& bytes) { bytes[at] = static_cast<char>(bytes[at] ^ 1 << random() % 8); },
          reported);
      EXPECT_GE(head, at_least) << file << " byte " << at << ": " << told_;
      // A flaw in the last write is taken for a torn tail; any other must be told.
      if (head + kLargestGroup < kRecords) {
        EXPECT_TRUE(reported) << file << " byte " << at << ", head " << head;
      }
    }
  }

  void cut(const std::string& file, int times, std::uint64_t at_least) {
    std::mt19937 random(6);
    for (int i = 0; i < times; ++i) {
      bool reported = false;
      std::size_t size = 0;
      const std::uint64_t head = head_after(
          file,
          [&](std::string& bytes) {
            size = random() % bytes.size();
            bytes.resize(size);
          },
          reported);
      EXPECT_GE(head, at_least) << file << " cut at " << size << ": " << told_;
      // A log that ends early looks like a torn tail (README); any other loss must be told.
      EXPECT_TRUE(reported || head == kRecords || file.ends_with(".log")) << file << ' ' << size;
    }
  }

  static std::unique_ptr<test::TemporaryFolder> original_;
  static std::vector<ContentHash> chain_;
  test::TemporaryFolder folder_;
  std::string told_;  // by the last opening
};
std::unique_ptr<test::TemporaryFolder> Damage::original_;
std::vector<ContentHash> Damage::chain_;

TEST_F(Damage, OfTheLogIsFoundAndTheGoodBeginningServed) {
  flip_bits(store_file(".log"), 20, 1);
  cut(store_file(".log"), 20, 1);
}

TEST_F(Damage, OfATableIsFoundAndTheGoodBeginningServed) {
  flip_bits(store_file(".sst"), 8, 0);
  cut(store_file(".sst"), 8, 0);
}

TEST_F(Damage, OfBlobsLosesNoRecord) {
  flip_bits(store_file(".blob"), 20, kRecords);
  cut(store_file(".blob"), 20, kRecords);
}

TEST_F(Damage, OfTheManifestLosesNoRecord) {
  flip_bits(store_file("MANIFEST"), 8, kRecords);
  cut(store_file("MANIFEST"), 20, kRecords);
}

// What a power failure leaves of an append: a header without its data, and data without theirs.
TEST_F(Damage, IsNotWhatAWriteToTheManifestLeftThatDidNotFinish) {
  const std::string nothing(60, '\0'), header("\x11\x22\x33\x44\x32\x00\x01", 7);
  for (const std::string& tail :
       {header + nothing, header + std::string(60, 'x'), header, header.substr(0, 3),
        nothing.substr(0, 3), nothing.substr(0, 6), nothing.substr(0, 7)}) {
    bool damage = false;
    const std::uint64_t head = head_after(
        store_file("MANIFEST"), [&](std::string& bytes) { bytes += tail; }, damage);
    EXPECT_EQ(head, kRecords) << told_;
    EXPECT_FALSE(damage) << told_;
  }
}

TEST_F(Damage, IsNotWhatAWriteToTheLogLeftThatDidNotFinish) {
  const std::string nothing(60, char());
  for (const std::size_t length : {1, 3, 6, 7, 60}) {
    bool damage = false;
    const std::uint64_t head = head_after(
        store_file(".log"), [&](std::string& bytes) { bytes += nothing.substr(0, length); },
        damage);
    EXPECT_EQ(head, kRecords) << told_;
    EXPECT_FALSE(damage) << length << ": " << told_;
  }
}

TEST_F(Damage, OfTheCurrentFileLosesNoRecord) {
  flip_bits("CURRENT", 4, kRecords);
  cut("CURRENT", 2, kRecords);
}

// Without CURRENT and MANIFEST the tables, blobs and logs still hold everything.
TEST_F(Damage, OfAllThatNamesFilesLosesNeitherRecordsNorPayloads) {
  const std::string copy = folder_.file("copy");
  fs::copy(original_->file("data"), copy, fs::copy_options::recursive);
  fs::remove(copy + "/store/CURRENT");
  fs::remove(copy + "/store/" + store_file("MANIFEST"));
  const auto journal = test::open_journal(copy, quick());
  EXPECT_EQ(journal->head().revision.number, kRecords);
  ASSERT_TRUE(journal->open_report().damage);
  EXPECT_EQ(journal->open_report().damage->payloads, kRecords / 20);
  for (std::uint64_t n = 1; n <= kRecords; n += 20)
    EXPECT_TRUE(journal->read_payload(content_hash(std::string(8000 + n, 'x')))) << n;
  EXPECT_TRUE(journal->verify());
}

TEST_F(Damage, ThatTookTheWholeStoreRaisesTheEraOfTheSameStore) {
  const std::string copy = folder_.file("copy");
  fs::copy(original_->file("data"), copy, fs::copy_options::recursive);
  const Revision before = test::open_journal(copy, quick())->head().revision;
  fs::remove_all(copy + "/store");
  const auto journal = test::open_journal(copy, quick());
  EXPECT_EQ(journal->head().revision, (Revision{before.store, before.era + 1, 0}));
  EXPECT_TRUE(journal->open_report().damage);
}

// Every change of a file is refused, as by a disk that was mounted read-only.
class ReadOnlyFileSystem : public rocksdb::FileSystemWrapper {
 public:
  ReadOnlyFileSystem() : FileSystemWrapper(rocksdb::FileSystem::Default()) {}
  [[nodiscard]] const char* Name() const override { return "ReadOnlyFileSystem"; }
  rocksdb::IOStatus NewWritableFile(const std::string& name, const rocksdb::FileOptions&,
                                    std::unique_ptr<rocksdb::FSWritableFile>*,
                                    rocksdb::IODebugContext*) override {
    return refuse(name);
  }
  rocksdb::IOStatus RenameFile(const std::string& name, const std::string&,
                               const rocksdb::IOOptions&, rocksdb::IODebugContext*) override {
    return refuse(name);
  }
  rocksdb::IOStatus DeleteFile(const std::string& name, const rocksdb::IOOptions&,
                               rocksdb::IODebugContext*) override {
    return refuse(name);
  }

 private:
  static rocksdb::IOStatus refuse(const std::string& name) {
    return rocksdb::IOStatus::IOError("Read-only file system", name);
  }
};

TEST(Journal, OnAReadOnlyDiskIsRefusedUntouched) {
  test::TemporaryFolder folder;
  { test::append_some(*test::open_journal(folder.file("data")), 1, 20); }
  JournalOptions options;
  options.file_system = std::make_shared<ReadOnlyFileSystem>();
  const auto refused = Journal::open(folder.file("data"), options);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("Read-only"), std::string::npos);
  const auto journal = test::open_journal(folder.file("data"));
  EXPECT_EQ(journal->head().revision.number, 20u);
  EXPECT_FALSE(journal->open_report().damage);
}

TEST(Journal, ThatMayNotGrowFailsWithoutLosingWhatItAcknowledged) {
  test::TemporaryFolder folder;
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  std::uint64_t acknowledged = 0;
  {
    const auto journal = test::open_journal(folder.file("data"));
    const rlimit small{200'000, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
    while (acknowledged < 5000 &&
           journal->append(test::some_records(acknowledged + 1, acknowledged + 5)))
      acknowledged += 5;
    EXPECT_TRUE(journal->failed());
    EXPECT_FALSE(journal->append(test::some_records(1, 1))) << "a failed journal takes nothing";
    setrlimit(RLIMIT_FSIZE, &before);
  }
  EXPECT_GT(acknowledged, 0u);
  EXPECT_LT(acknowledged, 5000u);
  const auto journal = test::open_journal(folder.file("data"));
  const JournalHead head = journal->head();
  EXPECT_FALSE(journal->open_report().damage);
  EXPECT_GE(head.revision.number, acknowledged);
  EXPECT_EQ(head.chain, test::some_chain(head.revision.number).back());
}

}  // namespace
}  // namespace cairn
