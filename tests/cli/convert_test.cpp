// SPDX-License-Identifier: BSD-3-Clause
// `cairn convert`, `cairn info` and `cairn eval` as a user meets them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/process.hpp"

namespace {

using namespace cairn::test;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kPlanar =
    "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nVERTEX_SE2 2 1 2 0\nFIX 0\n"
    "EDGE_SE2 0 1 1 0 0 4 0 0 9 0 16\nEDGE_SE2 1 2 0 1.5 0 4 0 0 4 0 4\n"
    "EDGE_SE2 2 0 -1 -2 0 1 0 0 1 0 1\n";

TEST(Convert, ChoosesTheFormatByExtension) {
  const TemporaryFolder folder;
  const std::string in = folder.write("in.g2o", kPlanar);
  const ProcessResult result = run_cairn({"convert", in, folder.file("out.graph")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("3 vertices, 3 edges"));
  EXPECT_EQ(read_file(folder.file("out.graph")),
            "VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0\nVERTEX2 2 1 2 0\nFIX 0\n"
            "EDGE2 0 1 1 0 0 4 0 9 16 0 0\nEDGE2 1 2 0 1.5 0 4 0 4 4 0 0\n"
            "EDGE2 2 0 -1 -2 0 1 0 1 1 0 0\n");
}

TEST(Convert, ReadsStandardInputAndWritesStandardOutput) {
  const ProcessResult result = run_cairn({"convert", "-", "-"}, kPlanar);
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out, kPlanar);
  EXPECT_THAT(result.err, HasSubstr("wrote standard output"));
}

TEST(Convert, WritesAndReadsCompressedFiles) {
  const TemporaryFolder folder;
  for (const char* ending : {".gz", ".bz2"}) {
    const std::string packed = folder.file(std::string("packed.g2o") + ending);
    ASSERT_EQ(run_cairn({"convert", "-", packed}, kPlanar).exit_code, 0);
    EXPECT_EQ(run_cairn({"convert", packed, "-"}).out, kPlanar);
  }
}

TEST(Convert, SaysThatIsamKeepsNoEstimates) {
  const ProcessResult result = run_cairn({"convert", "-", "-", "--to", "isam"}, kPlanar);
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, HasSubstr("ODOMETRY 0 1 1 0 0 2 0 0 3 0 4\n"));
  EXPECT_THAT(result.err, HasSubstr("warning: iSAM files hold no estimates; those of 3 vertices"));
}

TEST(Convert, LeavesNothingBehindWhenTheInputIsBroken) {
  const TemporaryFolder folder;
  const ProcessResult result =
      run_cairn({"convert", "-", folder.file("out.g2o")}, "VERTEX_SE2 0 0 0\n");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(result.err, "<stdin>:1:1: VERTEX_SE2 expects 4 numbers, found 3\n");
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(Convert, RefusesWhatTheFormatCannotHold) {
  const TemporaryFolder folder;
  const ProcessResult result =
      run_cairn({"convert", "-", folder.file("out.graph")},
                "VERTEX_SE2 0 0 0 0\nVERTEX_XY 1 1 1\nEDGE_SE2_XY 0 1 1 1 1 0 1\n");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err, "toro format cannot hold factors of type landmark_xy; choose g2o\n");
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(Convert, ReportsAFullDisk) {
  const ProcessResult result = run_cairn({"convert", "-", "/dev/full"}, kPlanar);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("No space left on device"));
}

TEST(Convert, MakesUnknownTagsErrorsWhenStrict) {
  const std::string text = std::string(kPlanar) + "ROBOTLASER1 1\n";
  EXPECT_EQ(run_cairn({"convert", "-", "-"}, text).out, text);
  const ProcessResult strict = run_cairn({"convert", "-", "-", "--strict"}, text);
  EXPECT_EQ(strict.exit_code, 3);
  EXPECT_EQ(strict.err, "<stdin>:8:1: unknown tag ROBOTLASER1\n");
}

TEST(Convert, TellsThatAFileDoesNotExist) {
  const ProcessResult result = run_cairn({"convert", "/nowhere/in.g2o", "-"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(result.err, "/nowhere/in.g2o: cannot read: No such file or directory\n");
  EXPECT_EQ(run_cairn({"convert", "in.g2o"}).exit_code, 2);
}

TEST(Info, TellsWhatAGraphHolds) {
  const ProcessResult result = run_cairn({"info", "-", "--json"}, kPlanar);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["format"], "g2o");
  EXPECT_EQ(json["vertices"], 3);
  EXPECT_EQ(json["edges"], 3);
  EXPECT_EQ(json["edges_by_type"]["between_se2"], 3);
  EXPECT_EQ(json["odometry_edges"], 2);
  EXPECT_EQ(json["loop_edges"], 1);
  EXPECT_EQ(json["components"], 1);
  EXPECT_EQ(json["fixed"], 1);
  EXPECT_EQ(json["dof"], 9 - 6);
  EXPECT_EQ(json["path_m"], 3.0);
  EXPECT_EQ(json["bounding_box_m"]["highest"], nlohmann::json({1.0, 2.0, 0.0}));
  EXPECT_NEAR(json["input_chi2"].get<double>(), 4.0 * 0.25, 1e-12);
  EXPECT_THAT(run_cairn({"info", "-"}, kPlanar).out, HasSubstr("3 between_se2"));
}

TEST(Info, HasNoChi2WithoutVertices) {
  const ProcessResult result =
      run_cairn({"info", "-", "--json"}, "EDGE_SE2 0 1 1 0 0 4 0 0 9 0 16\n");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(nlohmann::json::parse(result.out)["input_chi2"].is_null());
}

TEST(Eval, RefusesOptionsOfTheOtherMetric) {
  const TemporaryFolder folder;
  const std::string in = folder.write("in.g2o", kPlanar);
  EXPECT_EQ(run_cairn({"eval", "ate", in, in}).exit_code, 0);
  const ProcessResult result = run_cairn({"eval", "ate", in, in, "--delta", "5"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--delta and --pairs belong to rpe"));
}

}  // namespace
