// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/lint.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/diagnostics/lint_support.hpp"

namespace cairn {
namespace {

using test::places;

struct Row {
  const char* name;
  std::string text;
  std::vector<std::string> findings;  // "line:column CODE", notes included, in order
};

void PrintTo(const Row& row, std::ostream* out) { *out << row.name; }

class LintTable : public testing::TestWithParam<Row> {};

TEST_P(LintTable, FindsExactlyThis) {
  const LintReport report = lint_graph_text(GetParam().text, "x", {.solve = false});
  EXPECT_EQ(places(report), GetParam().findings) << test::messages(report);
}

const std::string kTwo = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n";
const std::string kEdge = "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n";
const std::string kFix = "FIX 0\n";
const std::string kGood = kTwo + kEdge + kFix;
const std::string kGoodSpace =
    "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 0 0 0 0 0 1\n"
    "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\nFIX 0\n";
const std::string kGoodToro =
    "VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0\nEDGE2 0 1 1 0 0 1 0 1 1 0 0\nFIX 0\n";

const Row kRows[] = {
    {"good g2o", kGood, {}},
    {"good 3-D g2o", kGoodSpace, {}},
    {"good TORO", kGoodToro, {}},
    {"good iSAM", "ODOMETRY 0 1 1 0 0 1 0 0 1 0 1\nLANDMARK 1 2 1 0 1 0 1\nFIX 0\n", {}},
    {"CRLF, comments, tabs, byte order mark",
     "\xEF\xBB\xBF# hello\r\n\r\nEDGE_SE2\t0 1 1 0 0 1 0 0 1 0 1 # why\r\nFIX 0\r\n",
     {"3:1 CHK036"}},
    {"empty", "", {"1:1 CHK002"}},
    {"only comments", "# nothing\n", {"1:1 CHK002"}},
    {"EDGE2 alone", "EDGE2 0 1 1 0 0 1 0 0 1 0 1\n", {"1:1 CHK002"}},
    {"another kind of file", "hello world\n", {"1:1 CHK002"}},
    {"binary", std::string("VERTEX_SE2 0\0 0 0 0\n", 20), {"1:1 CHK001"}},
    {"UTF-16", "\xFF\xFEV", {"1:1 CHK001"}},
    {"unknown tag", kGood + "VERTEX_SE2X 5 0 0 0\n", {"5:1 CHK003"}},
    {"tag of another format", kGood + "VERTEX2 5 0 0 0\n", {"5:1 CHK003"}},
    {"no tag", kGood + "1.5 2 3\n", {"5:1 CHK009"}},
    {"too few numbers", kGood + "EDGE_SE2 1 0 1 0 0 1 0 0 1 0\n", {"5:1 CHK004"}},
    {"too many numbers", kGood + "  EDGE_SE2 1 0 1 0 0 1 0 0 1 0 1 1\n", {"5:3 CHK004"}},
    {"tag alone", kGood + "EDGE_SE2\n", {"5:1 CHK004"}},
    {"FIX alone", kGood + "FIX\n", {"5:1 CHK004"}},
    {"a word", kGood + "EDGE_SE2 1 0 one 0 0 1 0 0 1 0 1\n", {"5:14 CHK005"}},
    {"hexadecimal", kGood + "EDGE_SE2 1 0 0x1 0 0 1 0 0 1 0 1\n", {"5:14 CHK005"}},
    {"two words in a line",
     kGood + "EDGE_SE2 1 0 a b 0 1 0 0 1 0 1\n",
     {"5:14 CHK005", "5:16 CHK005"}},
    {"decimal comma", kGood + "EDGE_SE2 1 0 1,25 0 0 1 0 0 1 0 1\n", {"5:14 CHK006"}},
    {"nan", kGood + "EDGE_SE2 1 0 nan 0 0 1 0 0 1 0 1\n", {"5:14 CHK007"}},
    {"infinity in a vertex",
     "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 inf 0 0\n" + kEdge + kFix,
     {"2:14 CHK007"}},
    {"overflow", kGood + "EDGE_SE2 1 0 1e999 0 0 1 0 0 1 0 1\n", {"5:14 CHK007"}},
    {"negative id", kGood + "EDGE_SE2 -1 0 1 0 0 1 0 0 1 0 1\n", {"5:10 CHK008"}},
    {"fractional id", kGood + "EDGE_SE2 1.0 0 1 0 0 1 0 0 1 0 1\n", {"5:10 CHK008"}},
    {"id beyond 64 bits",
     kGood + "EDGE_SE2 99999999999999999999 0 1 0 0 1 0 0 1 0 1\n",
     {"5:10 CHK008"}},
    {"bad id behind FIX", kGood + "FIX 1 x\n", {"2:1 CHK032", "2:1 CHK029", "5:7 CHK008"}},
    {"zero quaternion",
     kGoodSpace + "VERTEX_SE3:QUAT 2 0 0 0 0 0 0 0\n",
     {"5:1 CHK033", "5:25 CHK010"}},
    {"unnormalized quaternion",
     kGoodSpace + "EDGE_SE3:QUAT 1 0 1 0 0 0 0 0 2 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n",
     {"5:1 CHK028", "5:25 CHK011"}},
    {"indefinite", kGood + "EDGE_SE2 1 0 1 0 0 1 5 0 1 0 1\n", {"5:20 CHK012"}},
    {"negative diagonal", kGood + "EDGE_SE2 1 0 1 0 0 1 0 0 1 0 -1\n", {"5:20 CHK012"}},
    {"TORO's order in g2o",
     kTwo +
         "VERTEX_SE2 2 2 0 0\nEDGE_SE2 0 1 1 0 0 5 0 5 9 0 0\nEDGE_SE2 1 2 1 0 0 5 0 5 9 0 "
         "0\nEDGE_SE2 0 2 2 0 0 5 0 5 9 0 0\n" +
         kFix,
     {"4:20 CHK013"}},
    {"g2o's order in TORO",
     "VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0\nVERTEX2 2 2 0 0\nEDGE2 0 1 1 0 0 5 0 0 5 0 9\nEDGE2 1 2 1 "
     "0 0 5 0 0 5 0 9\nEDGE2 0 2 2 0 0 5 0 0 5 0 9\nFIX 0\n",
     {"4:17 CHK013"}},
    {"zero information", kGood + "EDGE_SE2 1 0 1 0 0 0 0 0 0 0 0\n", {"5:1 CHK028", "5:20 CHK014"}},
    {"singular information",
     kGood + "EDGE_SE2 1 0 -1 0 0 1 0 0 1 0 0\n",
     {"5:1 CHK015", "5:1 CHK028"}},
    {"vertex twice, alike", kGood + "VERTEX_SE2 1 1 0 0\n", {"5:1 CHK020"}},
    {"vertex twice, differently", kGood + "VERTEX_SE2 1 1 0 0.5\n", {"5:12 CHK021"}},
    {"offset twice",
     kGood + "PARAMS_SE2OFFSET 0 0 0 0\nPARAMS_SE2OFFSET 0 1 0 0\n",
     {"6:18 CHK021"}},
    {"self edge", kGood + "EDGE_SE2 1 1 1 0 0 1 0 0 1 0 1\n", {"5:12 CHK022"}},
    {"edge twice, alike", kGood + kEdge, {"5:1 CHK023"}},
    {"edge twice, differently", kGood + "EDGE_SE2 1 0 -1 0 0 1 0 0 1 0 1\n", {"5:1 CHK028"}},
    {"dangling", kGood + "EDGE_SE2 1 7 1 0 0 1 0 0 1 0 1\n", {"5:12 CHK024"}},
    {"landmarks left out", kGood + "EDGE_SE2_XY 1 7 1 0 1 0 1\n", {"5:1 CHK039"}},
    {"wrong type",
     kGood + "VERTEX_XY 7 1 1\nEDGE_SE2_XY 0 7 1 1 1 0 1\nEDGE_SE2 1 7 1 0 0 1 0 0 1 0 1\n",
     {"7:12 CHK025"}},
    {"offset missing", kGood + "EDGE_SE2_OFFSET 1 0 3 3 -1 0 0 1 0 0 1 0 1\n", {"5:21 CHK026"}},
    {"FIX of nothing", kGood + "FIX 7\n", {"5:5 CHK027"}},
    {"two parts",
     kGood + "VERTEX_SE2 4 0 0 0\nVERTEX_SE2 5 1 0 0\nEDGE_SE2 4 5 1 0 0 1 0 0 1 0 1\nFIX 4\n",
     {"5:1 CHK030"}},
    {"nothing fixed", kTwo + kEdge, {"0:0 CHK031"}},
    {"an absolute measurement needs no FIX",
     kTwo + kEdge + "EDGE_PRIOR_SE2 0 0 0 0 1 0 0 1 0 1\n",
     {}},
    {"vertex without edges", kGood + "VERTEX_SE2 4 0 0 0\n", {"5:1 CHK033"}},
    {"landmark with one bearing",
     kGood + "VERTEX_XY 7 1 1\nEDGE_BEARING_SE2_XY 0 7 0.5 1\n",
     {"5:1 CHK034"}},
    {"edges only", kEdge + kFix, {"1:1 CHK036"}},
    {"plane and space",
     kGood + "VERTEX_SE3:QUAT 8 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 9 1 0 0 0 0 0 1\nEDGE_SE3:QUAT 8 9 "
             "1 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\nFIX 8\n",
     {"5:1 CHK038", "5:1 CHK030"}},
    {"edge within a pose", kGoodToro + "EQUIV 0 9\nEDGE2 0 9 1 0 0 1 0 1 1 0 0\n", {"6:9 CHK019"}},
    {"no edges", kTwo, {"0:0 CHK092"}},
};

INSTANTIATE_TEST_SUITE_P(Lint, LintTable, testing::ValuesIn(kRows));

TEST(Lint, GoesOnAfterErrorsAndCountsBeyondTheLimit) {
  std::string text = kGood;
  for (int i = 0; i < 25; ++i) text += "EDGE_SE2 0 1 x 0 0 1 0 0 1 0 1\n";
  text += "EDGE_SE2 1 1 1 0 0 1 0 0 1 0 1\n";
  const LintReport report = lint_graph_text(text, "x", {.limit_per_code = 3, .solve = false});
  EXPECT_EQ(report.errors, 26u);
  EXPECT_EQ(report.counts.at(CheckCode::kNotANumber), 25u);
  EXPECT_EQ(places(report), (std::vector<std::string>{"5:14 CHK005", "6:14 CHK005", "7:14 CHK005",
                                                      "30:12 CHK022"}));
}

TEST(Lint, StrictTurnsWarningsIntoErrorsAndLeavesNotesAlone) {
  const std::string text = kTwo + kEdge + kEdge;
  EXPECT_TRUE(lint_graph_text(text, "x", {.solve = false}).clean());
  const LintReport strict = lint_graph_text(text, "x", {.strict = true, .solve = false});
  EXPECT_EQ(strict.errors, 1u);
  EXPECT_EQ(strict.warnings, 0u);
  EXPECT_EQ(strict.notes, 1u);
}

TEST(Lint, SaysWhatWasFoundAndWhatWasExpected) {
  const LintReport report =
      lint_graph_text(kGood + "EDGE_SE2 1 0 1 0 0 1 0 0 0 1 0 0 0 1\n", "x", {.solve = false});
  ASSERT_EQ(report.findings.size(), 1u);
  EXPECT_THAT(report.findings[0].message, testing::HasSubstr("EDGE_SE2 expects 11 numbers"));
  EXPECT_THAT(report.findings[0].message, testing::HasSubstr("found 14"));
  EXPECT_THAT(report.findings[0].hint, testing::HasSubstr("upper triangle"));
}

TEST(Lint, NamesTheSmallestEigenvalue) {
  const LintReport report =
      lint_graph_text(kGood + "EDGE_SE2 1 0 1 0 0 1 5 0 1 0 1\n", "x", {.solve = false});
  ASSERT_EQ(report.findings.size(), 1u);
  EXPECT_THAT(report.findings[0].message, testing::HasSubstr("smallest eigenvalue is -4"));
}

TEST(Lint, SuggestsTheNearestTag) {
  const LintReport report =
      lint_graph_text(kGood + "edge_se2 1 0 1 0 0 1 0 0 1 0 1\n", "x", {.solve = false});
  ASSERT_EQ(report.findings.size(), 1u);
  EXPECT_THAT(report.findings[0].hint, testing::HasSubstr("did you mean EDGE_SE2?"));
}

TEST(Lint, TellsAFileThatWasCutOff) {
  const LintReport report = lint_graph_text(kGood + "EDGE_SE2 1 0 1 0", "x", {.solve = false});
  ASSERT_EQ(report.findings.size(), 1u);
  EXPECT_THAT(report.findings[0].hint, testing::HasSubstr("cut off"));
}

TEST(Lint, ANamedFormatSettlesWhatTheTagsDoNot) {
  const LintReport report = lint_graph_text("EDGE2 0 1 1 0 0 1 0 1 1 0 0\nFIX 0\n", "x",
                                            {.format = GraphFormat::kToro, .solve = false});
  EXPECT_EQ(places(report), std::vector<std::string>{"1:1 CHK036"});
}

TEST(Lint, EveryCodeHasATitleAndAUniqueName) {
  std::set<std::string> names;
  for (const CheckCode code : all_check_codes()) {
    EXPECT_FALSE(title_of(code).empty());
    EXPECT_TRUE(names.insert(to_string(code)).second) << to_string(code);
  }
}

}  // namespace
}  // namespace cairn
