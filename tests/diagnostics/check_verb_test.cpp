// SPDX-License-Identifier: BSD-3-Clause
// The command itself: exit codes, standard input and output, compressed files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/diagnostics/lint_support.hpp"

namespace cairn {
namespace {

class CheckVerb : public testing::Test {
 protected:
  CheckVerb() {
    folder_ = std::filesystem::temp_directory_path() /
              ("cairn_check_" +
               std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    write("good.g2o",
          "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nFIX 0\n");
    write("warning.g2o", test::read_file(path("good.g2o")) + "VERTEX_SE2 5 0 0 0\n");
    write("broken.g2o", test::read_file(path("good.g2o")) + "EDGE_SE2 1 0 -1,5 0 0 1 0 0 1 0 1\n");
  }
  ~CheckVerb() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / name).string();
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
  }
  // Runs `cairn check ARGUMENTS` in the folder; output goes to out.txt and err.txt.
  [[nodiscard]] int check(const std::string& arguments) const {
    const std::string command = "cd '" + folder_.string() + "' && '" CAIRN_BINARY "' check " +
                                arguments + " >out.txt 2>err.txt";
    return WEXITSTATUS(std::system(command.c_str()));
  }
  [[nodiscard]] std::string output() const { return test::read_file(path("out.txt")); }

  std::filesystem::path folder_;
};

TEST_F(CheckVerb, ExitCodesTellErrorsFromWarnings) {
  EXPECT_EQ(check("good.g2o"), 0);
  EXPECT_EQ(check("warning.g2o"), 0);
  EXPECT_EQ(check("--strict warning.g2o"), 3);
  EXPECT_EQ(check("broken.g2o"), 3);
  EXPECT_EQ(check("missing.g2o"), 3);
  EXPECT_EQ(check("."), 2);
  EXPECT_EQ(check("good.g2o --format dlr"), 2);
  EXPECT_EQ(check("good.g2o --fix - --json -"), 2);
}

TEST_F(CheckVerb, NamesFileLineColumnAndCode) {
  EXPECT_EQ(check("broken.g2o"), 3);
  EXPECT_THAT(output(),
              testing::HasSubstr(
                  "broken.g2o:5:14: error: '-1,5' has a decimal comma; write -1.5 [CHK006]"));
}

TEST_F(CheckVerb, ReadsStandardInputAndCompressedFiles) {
  EXPECT_EQ(check("- < warning.g2o"), 0);
  EXPECT_THAT(output(), testing::HasSubstr("<stdin>:5:1: warning:"));
  ASSERT_EQ(check("broken.g2o --fix fixed.g2o.gz"), 0);
  EXPECT_EQ(check("fixed.g2o.gz"), 0);
  ASSERT_EQ(check("broken.g2o --fix fixed.g2o.bz2"), 0);
  EXPECT_EQ(check("fixed.g2o.bz2"), 0);
}

TEST_F(CheckVerb, FixWritesTheRepairedTextAndSaysWhatItDid) {
  EXPECT_EQ(check("broken.g2o --fix fixed.g2o"), 0);
  EXPECT_THAT(output(),
              testing::HasSubstr("broken.g2o:5: fixed: wrote points for 1 decimal comma [CHK006]"));
  EXPECT_THAT(test::read_file(path("fixed.g2o")), testing::HasSubstr("EDGE_SE2 1 0 -1.5 0 0"));
  EXPECT_EQ(check("fixed.g2o"), 0);
}

TEST_F(CheckVerb, FixToStandardOutputKeepsTheReportOutOfIt) {
  EXPECT_EQ(check("broken.g2o --fix -"), 0);
  EXPECT_THAT(output(), testing::StartsWith("VERTEX_SE2 0 0 0 0\n"));
  EXPECT_THAT(output(), testing::Not(testing::HasSubstr("fixed:")));
}

TEST_F(CheckVerb, FixLeavesNothingBehindWhereNothingIsUnderstood) {
  write("photo.jpg", std::string("\xFF\xD8\0\0", 4));
  EXPECT_EQ(check("photo.jpg --fix out.g2o"), 3);
  EXPECT_FALSE(std::filesystem::exists(path("out.g2o")));
}

TEST_F(CheckVerb, JsonHoldsFindingsAndChanges) {
  EXPECT_EQ(check("broken.g2o --fix fixed.g2o --json report.json"), 0);
  const auto json = nlohmann::json::parse(test::read_file(path("report.json")));
  EXPECT_EQ(json["schema_version"], 1);
  EXPECT_EQ(json["format"], "g2o");
  EXPECT_EQ(json["errors"], 1);
  EXPECT_EQ(json["findings"][0]["code"], "CHK006");
  EXPECT_EQ(json["findings"][0]["line"], 5);
  EXPECT_EQ(json["changes"].size(), 1u);
  EXPECT_EQ(json["after"]["errors"], 0);
}

}  // namespace
}  // namespace cairn
