// SPDX-License-Identifier: BSD-3-Clause
#include "clients/client/spool.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/client/temporary_folder.hpp"

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
};

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
