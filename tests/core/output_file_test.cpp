// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/core/output_file.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace {

using cairn::OutputFile;
using cairn::test::read_file;

TEST(OutputFile, AppearsOnlyWithCommit) {
  const cairn::test::TemporaryFolder folder;
  auto file = OutputFile::create(folder.file("a.txt"));
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->write("hello"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("a.txt")));
  ASSERT_TRUE(file->commit());
  EXPECT_EQ(read_file(folder.file("a.txt")), "hello");
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(OutputFile, LeavesTheOldFileAndNoTemporaryWithoutCommit) {
  const cairn::test::TemporaryFolder folder;
  const std::string path = folder.write("a.txt", "old");
  {
    auto file = OutputFile::create(path);
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->write("new"));
  }
  EXPECT_EQ(read_file(path), "old");
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(OutputFile, ReplacesWhatALinkPointsAtAndKeepsItsMode) {
  const cairn::test::TemporaryFolder folder;
  const std::string target = folder.write("target.txt", "old");
  std::filesystem::permissions(target, std::filesystem::perms(0640));
  std::filesystem::create_symlink(target, folder.file("link.txt"));
  ASSERT_TRUE(cairn::write_file(folder.file("link.txt"), "new"));
  EXPECT_EQ(read_file(target), "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder.file("link.txt")));
  EXPECT_EQ(std::filesystem::status(target).permissions(), std::filesystem::perms(0640));
}

TEST(OutputFile, WritesDevicesInPlace) {
  ASSERT_TRUE(cairn::write_file("/dev/null", "x"));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(OutputFile, ReportsAFullDiskAsAMachineError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full here";
  const auto written = cairn::write_file("/dev/full", "x");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, cairn::ErrorCode::kInternal);
}

TEST(OutputFile, NamesAMissingFolder) {
  const auto written = cairn::write_file("/nowhere/a.txt", "x");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().to_string(),
            "/nowhere/a.txt: cannot create the file: No such file or directory; choose a folder "
            "that exists and that you may write to");
  EXPECT_EQ(cairn::check_writable("/nowhere/a.txt").error().to_string(),
            written.error().to_string());
}

TEST(OutputFile, TakesNamesWithoutAFolder) {
  const cairn::test::TemporaryFolder folder;
  const auto here = std::filesystem::current_path();
  std::filesystem::current_path(folder.file(""));
  EXPECT_TRUE(cairn::check_writable("plain.txt"));
  EXPECT_TRUE(cairn::write_file("plain.txt", "x"));
  EXPECT_TRUE(cairn::check_writable("plain.txt"));
  std::filesystem::current_path(here);
  EXPECT_EQ(read_file(folder.file("plain.txt")), "x");
}

TEST(OutputFile, RefusesAFolder) {
  const cairn::test::TemporaryFolder folder;
  EXPECT_FALSE(cairn::write_file(folder.file(""), "x"));
  EXPECT_FALSE(cairn::check_writable(folder.file("")));
}

}  // namespace
