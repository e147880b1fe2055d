// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/process.hpp"

namespace {

using namespace cairn::test;
using testing::HasSubstr;
using testing::Not;

TEST(Help, ListsVerbsAndShowsDefaults) {
  const auto help = run_cairn({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, HasSubstr("optimize"));
  EXPECT_THAT(help.out, Not(HasSubstr("generate-docs")));
  const auto optimize = run_cairn({"optimize", "--help"});
  EXPECT_EQ(optimize.exit_code, 0);
  EXPECT_THAT(optimize.out, HasSubstr("{auto|file|odometry|tree|chordal}=auto"));
  EXPECT_THAT(optimize.out, HasSubstr("--max-iterations N=100"));
  EXPECT_EQ(run_cairn({"--version"}).out, "cairn 0.1.0\n");
}

TEST(ManualPages, DescribeEveryOptionOfHelp) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_cairn({"generate-docs", folder.file("docs")}).exit_code, 0);
  const std::string page = read_file(folder.file("docs/man1/cairn-optimize.1"));
  EXPECT_THAT(page, HasSubstr(".SH SYNOPSIS"));
  EXPECT_THAT(page, HasSubstr("\\-\\-covariances"));
  EXPECT_THAT(page, HasSubstr("default 100"));
  EXPECT_THAT(read_file(folder.file("docs/man1/cairn.1")), HasSubstr("cairn\\-optimize"));
}

TEST(Completion, OffersVerbsOptionsAndWords) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_cairn({"generate-docs", folder.file("docs")}).exit_code, 0);
  const auto complete = [&](const std::string& words, int at) {
    const std::string script = "source '" + folder.file("docs/bash-completion/cairn") +
                               "'; COMP_WORDS=(" + words + "); COMP_CWORD=" + std::to_string(at) +
                               "; _cairn; echo \"${COMPREPLY[*]}\"";
    return Process({"/bin/bash", "-c", script}).wait().out;
  };
  EXPECT_EQ(complete("cairn opt", 1), "optimize\n");
  EXPECT_EQ(complete("cairn optimize --meth", 2), "--method\n");
  EXPECT_EQ(complete("cairn optimize --method ''", 3), "lm gn dogleg\n");
  EXPECT_EQ(complete("cairn optimize in.g2o --cov", 3), "--covariances\n");
  EXPECT_EQ(complete("cairn optimize --json x", 3), "\n") << "a file name: left to bash";
}

}  // namespace
