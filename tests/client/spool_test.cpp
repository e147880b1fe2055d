// SPDX-License-Identifier: BSD-3-Clause
#include "clients/client/spool.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <fstream>

#include "tests/support/temporary_folder.hpp"

namespace {
std::atomic<int> failing_syncs = 0;  // so many of the next ones
}

// In place of the C library's, for this program.
extern "C" int fdatasync(int file) {
  if (failing_syncs == 0) return static_cast<int>(syscall(SYS_fdatasync, file));
  --failing_syncs;
  errno = EIO;
  return -1;
}

namespace cairn {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SpoolTest : public testing::Test {
 protected:
  test::TemporaryFolder folder_;

  [[nodiscard]] SpoolOptions options() const {
    return {.folder = folder_.path() / "spool", .source = "wheels"};
  }
  [[nodiscard]] Spool open() const {
    auto spool = Spool::open(options());
    EXPECT_TRUE(spool) << (spool ? "" : spool.error().to_string());
    return std::move(*spool);
  }
  [[nodiscard]] fs::path newest_file() const {
    fs::path newest;
    for (const auto& entry : fs::directory_iterator(options().folder))
      if (entry.path().extension() == ".spool") newest = std::max(newest, entry.path());
    return newest;
  }
  static void flip_bit(const fs::path& path, std::streamoff at) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(at);
    const int byte = file.get();
    file.seekp(at);
    file.put(static_cast<char>(byte ^ 1));
  }
};

TEST_F(SpoolTest, GoesOnAfterACrashThatLeftZerosBehindTheRecords) {
  const fs::path killed = folder_.path() / "killed";
  {
    Spool spool = open();
    ASSERT_TRUE(spool.append({"first", "second"}));
    EXPECT_GT(fs::file_size(newest_file()), spool.bytes());
    fs::copy(options().folder, killed, fs::copy_options::recursive);
  }
  EXPECT_EQ(fs::file_size(newest_file()), Spool::bytes_of("first") + Spool::bytes_of("second"));
  auto again = Spool::open({.folder = killed, .source = "wheels"});
  ASSERT_TRUE(again) << again.error().to_string();
  EXPECT_EQ(again->bytes(), Spool::bytes_of("first") + Spool::bytes_of("second"));
  EXPECT_EQ(again->next_sequence(), 3u);
  ASSERT_TRUE(again->append({"third"}));
  EXPECT_EQ(*again->read(2), "second");
  EXPECT_EQ(*again->read(3), "third");
}

TEST_F(SpoolTest, GoesOnInItsEpochAndSequenceAfterARestart) {
  std::uint64_t epoch = 0;
  {
    Spool spool = open();
    epoch = spool.epoch();
    EXPECT_NE(epoch, 0u);
    EXPECT_EQ(spool.next_sequence(), 1u);
    ASSERT_TRUE(spool.append({"one", "two", ""}));
  }
  Spool spool = open();
  EXPECT_EQ(spool.epoch(), epoch);
  EXPECT_EQ(spool.next_sequence(), 4u);
  ASSERT_TRUE(spool.append({"four"}));
  EXPECT_EQ(*spool.read(2), "two");
  EXPECT_EQ(*spool.read(3), "");
  EXPECT_EQ(*spool.read(4), "four");
  EXPECT_EQ(*spool.read(1), "one");
  EXPECT_THAT(spool.read(5).error().message, HasSubstr("keeps sequences 1 to 4, not 5"));
}

TEST_F(SpoolTest, EpochsOfDifferentSpoolsDiffer) {
  auto other = Spool::open({.folder = folder_.path() / "other", .source = "wheels"});
  EXPECT_NE(open().epoch(), other->epoch());
}

TEST_F(SpoolTest, CutsATornTailAtAnyByte) {
  {
    Spool spool = open();
    ASSERT_TRUE(spool.append({"first", "second"}));
  }
  const auto whole = fs::file_size(newest_file());
  const auto begin_of_second = Spool::bytes_of("first");
  for (auto bytes = whole - 1; bytes > begin_of_second; --bytes) {
    SCOPED_TRACE(bytes);
    fs::resize_file(newest_file(), bytes);
    Spool spool = open();
    EXPECT_EQ(spool.next_sequence(), 2u);
    EXPECT_EQ(*spool.read(1), "first");
    ASSERT_TRUE(spool.append({"second"}));
    EXPECT_EQ(*spool.read(2), "second");
  }
}

TEST_F(SpoolTest, CutsATailWhoseBytesNeverArrived) {
  {
    Spool spool = open();
    ASSERT_TRUE(spool.append({"first", "second"}));
  }
  std::fstream file(newest_file(), std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(-3, std::ios::end);
  file.put('\0');
  file.close();
  EXPECT_EQ(open().next_sequence(), 2u);
}

TEST_F(SpoolTest, RefusesToOpenWhereWholeRecordsFollowADamagedOne) {
  const auto second = static_cast<std::streamoff>(Spool::bytes_of("first"));
  {
    Spool spool = open();
    ASSERT_TRUE(spool.append({"first", "second", "third"}));
  }
  const auto size = fs::file_size(newest_file());
  for (const std::streamoff byte : {0, 3, 4, 8, 15, 16, 21}) {  // of each field of the record
    SCOPED_TRACE(byte);
    flip_bit(newest_file(), second + byte);
    const auto damaged = Spool::open(options());
    ASSERT_FALSE(damaged);
    EXPECT_EQ(damaged.error().code, ErrorCode::kBadInput);
    EXPECT_THAT(damaged.error().message, HasSubstr("sequence 2 is damaged"));
    EXPECT_EQ(damaged.error().place, newest_file().string() + ':' + std::to_string(second));
    EXPECT_EQ(fs::file_size(newest_file()), size);  // nothing was cut
    flip_bit(newest_file(), second + byte);
  }
  EXPECT_EQ(*open().read(3), "third");
}

TEST_F(SpoolTest, TakesBackWhatTheDiskDidNotKeep) {
  {
    Spool spool = open();
    ASSERT_TRUE(spool.append({"first"}));
    failing_syncs = 1;
    const auto failed = spool.append({"never", "sent"});
    ASSERT_FALSE(failed);
    EXPECT_THAT(failed.error().message, HasSubstr("fdatasync"));
    EXPECT_EQ(spool.next_sequence(), 2u);
    EXPECT_EQ(fs::file_size(newest_file()), spool.bytes());
  }
  Spool spool = open();
  EXPECT_EQ(spool.next_sequence(), 2u);
  ASSERT_TRUE(spool.append({"second"}));
  EXPECT_EQ(*spool.read(2), "second");
}

TEST_F(SpoolTest, TakesNothingMoreWhereItCannotTakeBack) {
  Spool spool = open();
  failing_syncs = 2;
  EXPECT_THAT(spool.append({"first"}).error().message, HasSubstr("may be sent after a restart"));
  EXPECT_FALSE(spool.append({"first"}));
  EXPECT_EQ(spool.next_sequence(), 1u);
}

TEST_F(SpoolTest, IsFullAtItsBoundAndLosesNothing) {
  SpoolOptions small = options();
  small.most_bytes = 1000;
  auto spool = Spool::open(small);
  const std::string record(84, 'x');  // 100 bytes on disk
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(spool->append({record}));
  const auto refused = spool->append({record});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("spool full: 1000 of 1000 bytes"));
  EXPECT_EQ(spool->next_sequence(), 11u);
  spool->release(9);  // half is kept in case the daemon loses its tail
  EXPECT_LE(spool->bytes(), 600u);
  EXPECT_EQ(spool->oldest_kept(), 6u);
  ASSERT_TRUE(spool->append({record}));
  for (std::uint64_t i = spool->oldest_kept(); i <= 11; ++i) EXPECT_EQ(*spool->read(i), record);
}

TEST_F(SpoolTest, ReleasesNothingThatIsNotDecided) {
  SpoolOptions small = options();
  small.most_bytes = 1000;
  auto spool = Spool::open(small);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(spool->append({std::string(84, 'x')}));
  spool->release(3);
  EXPECT_EQ(spool->oldest_kept(), 4u);
}

TEST_F(SpoolTest, IsLockedAgainstASecondProcessAndAnotherSource) {
  {
    Spool spool = open();
    const auto second = Spool::open(options());
    ASSERT_FALSE(second);
    EXPECT_THAT(second.error().message, HasSubstr("in use by another process"));
  }
  SpoolOptions other = options();
  other.source = "sonar";
  const auto foreign = Spool::open(other);
  ASSERT_FALSE(foreign);
  EXPECT_THAT(foreign.error().message, HasSubstr("belongs to source \"wheels\", not \"sonar\""));
}

TEST_F(SpoolTest, SaysWhereAnOlderRecordIsDamaged) {
  SpoolOptions small = options();
  small.most_bytes = 1000;
  {
    auto spool = Spool::open(small);
    for (int i = 0; i < 4; ++i) ASSERT_TRUE(spool->append({std::string(84, 'x')}));
  }
  std::fstream(options().folder / "00000000000000000001.spool",
               std::ios::in | std::ios::out | std::ios::binary)
      .put('\xFF');
  auto spool = Spool::open(small);
  const auto damaged = spool->read(1);
  ASSERT_FALSE(damaged);
  EXPECT_THAT(damaged.error().place, HasSubstr("00000000000000000001.spool:0"));
  EXPECT_TRUE(spool->read(2));
}

}  // namespace
}  // namespace cairn
