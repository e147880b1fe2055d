// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/picture_files.hpp"
#include "tests/support/process.hpp"

namespace {

using namespace cairn::test;
using testing::HasSubstr;

constexpr const char* kGraph =
    "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n";

TEST(Plot, DrawsPngAndSvg) {
  const TemporaryFolder folder;
  const std::string in = folder.write("a.g2o", kGraph);
  EXPECT_EQ(run_cairn({"plot", in, folder.file("a.svg")}).exit_code, 0);
  EXPECT_TRUE(is_well_formed_svg(read_file(folder.file("a.svg"))));
  EXPECT_EQ(
      run_cairn({"plot", "-", folder.file("a.png"), "--size", "640x400", "--title", "one"}, kGraph)
          .exit_code,
      0);
  EXPECT_EQ(png_size(read_file(folder.file("a.png"))), std::pair(640, 400));
  EXPECT_EQ(run_cairn({"plot", in, in, folder.file("b.png"), "--truth", in}).exit_code, 0);
  EXPECT_EQ(png_size(read_file(folder.file("b.png"))), std::pair(1600, 900));
}

TEST(Plot, RefusesBadUsageAndBadInputWithoutLeavingFiles) {
  const TemporaryFolder folder;
  const std::string in = folder.write("a.g2o", kGraph), out = folder.file("out.svg");
  EXPECT_EQ(run_cairn({"plot", in}).exit_code, 2);
  EXPECT_EQ(run_cairn({"plot", in, folder.file("out.pdf")}).exit_code, 2);
  EXPECT_EQ(run_cairn({"plot", in, out, "--size", "big"}).exit_code, 2);
  EXPECT_EQ(run_cairn({"plot", in, out, "--size", "1x1"}).exit_code, 2);
  EXPECT_EQ(run_cairn({"plot", folder.file("missing.g2o"), out}).exit_code, 3);
  EXPECT_EQ(folder.file_count(), 1u);
}

}  // namespace
