// SPDX-License-Identifier: BSD-3-Clause
// The verbs that read a data folder without a daemon.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/data_folder.hpp"
#include "tests/support/process.hpp"

namespace {

using namespace cairn;
using namespace cairn::test;
using nlohmann::json;
using testing::HasSubstr;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Records 1 to 30: a drive. 31 to 53: what the gate says of its 23 loops. 54: the solve. 55: a
// refusal. 56: camera disables a loop. 57: a solve.
class DataVerbs : public testing::Test {
 protected:
  void SetUp() override {
    DataFolderMaker maker(data());
    maker.submit_all(drive(30));
    maker.solve();
    maker.submit(impossible_step());
    Transaction edit;
    edit.edits.push_back({{{"laser", 7, 20}, 1}, FactorChange::kDisable});
    maker.submit(edit, "camera");
    maker.solve();
  }
  [[nodiscard]] std::string data() const { return folder_.file("data"); }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  [[nodiscard]] ProcessResult run(std::vector<std::string> words) const {
    words.insert(words.end(), {"--data", data()});
    return run_cairn(words);
  }

  TemporaryFolder folder_;
};

TEST_F(DataVerbs, LogTellsWhatEachRecordDid) {
  const auto log = run({"log"});
  ASSERT_EQ(log.exit_code, 0) << log.err;
  const auto lines = lines_of(log.out);
  ASSERT_EQ(lines.size(), 57u);
  EXPECT_THAT(lines[7], HasSubstr("8  2026-01-01T00:00:07.000Z  transaction  laser/8"));
  EXPECT_THAT(lines[7],
              HasSubstr("+1 SE(2) pose (robot/3/7), +1 between_se2, +1 between_se2 (loop)"));
  EXPECT_THAT(lines[30], HasSubstr("verdict"));
  EXPECT_THAT(lines[30], HasSubstr("laser/8#1 is committed: fits the map "));
  EXPECT_THAT(lines[54], HasSubstr("refusal"));
  EXPECT_THAT(lines[54], HasSubstr("the node robot/3/77777 is not known"));
  EXPECT_THAT(lines[55], HasSubstr("camera/1"));
  EXPECT_THAT(lines[56], HasSubstr("of record 56: 29 estimates changed"));
}

TEST_F(DataVerbs, LogShowsTheNewestThatFit) {
  EXPECT_EQ(lines_of(run({"log", "--limit", "3"}).out).size(), 3u);
  EXPECT_THAT(run({"log", "--limit", "1", "--source", "laser", "--kind", "transaction"}).out,
              HasSubstr("laser/30"));
  EXPECT_EQ(lines_of(run({"log", "--kind", "solve"}).out).size(), 2u);
  const auto some = lines_of(run({"log", "--from", "4", "--to", "6", "--json"}).out);
  ASSERT_EQ(some.size(), 3u);
  EXPECT_EQ(json::parse(some[0])["number"], 4);
  EXPECT_EQ(json::parse(some[0])["source"], "laser");
  EXPECT_EQ(json::parse(some[2])["sequence"], 6);
  const auto beyond = run({"log", "--from", "99"});
  EXPECT_EQ(beyond.exit_code, 2);
  EXPECT_THAT(beyond.err, HasSubstr("the newest is 57"));
}

TEST_F(DataVerbs, ShowTellsEverythingAboutARecord) {
  const auto text = run({"show", "9"});
  ASSERT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("kind: transaction\n"));
  EXPECT_THAT(text.out, HasSubstr("  - node: robot/3/8\n"));
  EXPECT_THAT(text.out, HasSubstr("nodes: [\"robot/3/7\",\"robot/3/8\"]\n"));
  const auto shown = json::parse(run({"show", "9", "--json"}).out);
  EXPECT_EQ(shown["key"]["sequence"], 9);
  EXPECT_EQ(shown["factors"][0]["numbers"].size(), 9u);
  EXPECT_EQ(shown["factors"][1]["kind"], "loop");
  EXPECT_EQ(json::parse(run({"show", "54", "--json"}).out)["changed"].size(), 29u);
  EXPECT_EQ(json::parse(run({"show", "55", "--json"}).out)["refusal"], "unknown variable");
  EXPECT_EQ(json::parse(run({"show", "56", "--json"}).out)["edits"][0]["factor"], "laser/20#1");
  EXPECT_EQ(run({"show", "58"}).exit_code, 2);
}

TEST_F(DataVerbs, DiffTellsWhatHappenedToTheMap) {
  const auto grown = json::parse(run({"diff", "10", "30", "--json"}).out);
  EXPECT_EQ(grown["variables_added"].size(), 20u);
  EXPECT_EQ(grown["factors_added"].size(), 40u);
  EXPECT_EQ(grown["moved"]["count"], 0);
  EXPECT_TRUE(grown["moved"]["largest_m"].is_null());
  const auto solved = run({"diff", "30", "57"});
  EXPECT_THAT(solved.out, HasSubstr("0 variables added\n0 factors added\n"));
  EXPECT_THAT(solved.out, HasSubstr("1 factors now disabled: laser/20#1\n"));
  EXPECT_THAT(solved.out, HasSubstr("29 estimates moved, at most "));
  EXPECT_EQ(json::parse(run({"diff", "0", "57", "--json"}).out)["variables_added"].size(), 30u);
  EXPECT_THAT(run({"diff", "9", "3"}).err, HasSubstr("try diff 3 9"));
  EXPECT_EQ(run({"diff", "3", "99"}).exit_code, 2);
}

TEST_F(DataVerbs, ExportedGraphIsTheSettledMap) {
  const auto exported = run({"export", "graph", file("out.g2o")});
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  const auto again = run_cairn({"optimize", file("out.g2o"), "--json", "-"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const auto report = json::parse(again.out);
  EXPECT_EQ(report["vertices"], 30);
  EXPECT_EQ(report["edges"], 29 + 23 - 1) << "one is disabled";
  EXPECT_NEAR(report["input_chi2"], report["final_chi2"], 1e-6);
  EXPECT_THAT(read_file(file("out.ids.csv")), HasSubstr("id,robot,epoch,index\n0,robot,3,0\n"));
  // The live estimate is that of the last solve, which was of the same map.
  ASSERT_EQ(run({"export", "graph", file("live.g2o"), "--live"}).exit_code, 0);
  EXPECT_EQ(read_file(file("live.g2o")), read_file(file("out.g2o")));
  EXPECT_EQ(run({"export", "graph", "-"}).out, read_file(file("out.g2o")));
}

TEST_F(DataVerbs, StatusCountsWhatEachSourceSent) {
  const auto status = json::parse(run({"status", "--json"}).out);
  EXPECT_EQ(status["variables"], 30);
  EXPECT_EQ(status["factors"], 52);
  EXPECT_EQ(status["solved_revision"], 56);
  ASSERT_EQ(status["sources"].size(), 2u);
  const auto& laser = status["sources"][1];
  EXPECT_EQ(laser["source"], "laser");
  EXPECT_EQ(laser["highest_decided"], 31);
  EXPECT_EQ(laser["accepted"], 30);
  EXPECT_EQ(laser["refused"], 1);
  EXPECT_THAT(std::string(laser["last_refusal"]), HasSubstr("unknown variable"));
  EXPECT_THAT(run({"status"}).out, HasSubstr("30 variables, 52 factors"));
}

TEST_F(DataVerbs, SettleAppendsASolveOnce) {
  DataFolderMaker(file("new")).submit_all(drive(25));
  const auto settle = [&] { return run_cairn({"settle", "--data", file("new")}); };
  const auto first = settle();
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr(":0:44, chi2 "));
  EXPECT_EQ(settle().out, first.out);
  EXPECT_THAT(run_cairn({"verify", "--data", file("new")}).out,
              HasSubstr("1 solves solved again with the same bits"));
}

TEST_F(DataVerbs, EdgesAreSwitchedAndUndoneAndTheStoryIsKept) {
  const auto shown = run({"edge", "show", "25"});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  const auto lines = lines_of(shown.out);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_THAT(lines[1], HasSubstr("25:1        committed    chi2 "));
  EXPECT_THAT(lines[1], HasSubstr("between_se2 (loop) robot/3/17 robot/3/24"));

  const auto worst = lines_of(run({"edge", "worst", "--limit", "3"}).out);
  ASSERT_EQ(worst.size(), 3u);
  double before = INFINITY;
  for (const std::string& line : worst) {
    const double chi2 = std::stod(line.substr(line.find("chi2 ") + 5));
    EXPECT_LE(chi2, before);
    EXPECT_GT(chi2, 0.0);
    before = chi2;
    const std::string record = line.substr(0, line.find(':'));
    EXPECT_THAT(run({"edge", "show", record}).out, HasSubstr(line));
  }

  const auto switched =
      run({"edge", "disable", "25:1", "26:1", "--reason", "a mirror", "--operator", "anna"});
  ASSERT_EQ(switched.exit_code, 0) << switched.err;
  EXPECT_EQ(switched.out, "2 factors disabled, record 58\n");
  EXPECT_EQ(run({"edge", "disable", "25:1"}).out, "nothing changed: it is so already\n");
  EXPECT_EQ(run({"undo", "20"}).exit_code, 4) << "later poses stand on it";
  EXPECT_EQ(run({"settle", "-q"}).exit_code, 0);
  const auto undone = run({"undo", "58", "--operator", "bert"});
  ASSERT_EQ(undone.exit_code, 0) << undone.err;
  EXPECT_EQ(undone.out, "2 factors enabled, record 60\n");

  const auto log = lines_of(run({"log"}).out);
  ASSERT_EQ(log.size(), 60u);
  EXPECT_THAT(log[57], HasSubstr("anna: edge disable 25:1 26:1: 2 factors disabled (a mirror)"));
  EXPECT_THAT(log[59], HasSubstr("bert: undo 58: 2 factors enabled"));
  EXPECT_THAT(run({"show", "58"}).out, HasSubstr("laser/25#1"));
  const auto verified = run({"verify"});
  EXPECT_EQ(verified.exit_code, 0) << verified.err << verified.out;
  EXPECT_EQ(run({"edge", "disable", "1:0"}).exit_code, 2);
  const auto latin = run({"edge", "disable", "25:1", "--reason", "\xe4rger"});
  EXPECT_EQ(latin.exit_code, 2);
  EXPECT_THAT(latin.err, HasSubstr("--reason is not UTF-8"));
  EXPECT_EQ(run({"undo", "54"}).exit_code, 2) << "a solve";
  EXPECT_EQ(run_cairn({"edge"}).exit_code, 2);
}

TEST_F(DataVerbs, BackupsAreRestoredIntoANewEra) {
  ASSERT_EQ(run({"backup", file("backups")}).exit_code, 0);
  const auto restored = run_cairn({"restore", file("backups"), "--data", file("again")});
  ASSERT_EQ(restored.exit_code, 0) << restored.err;
  EXPECT_THAT(restored.out, HasSubstr(":1:57"));
  const auto hash = [](const ProcessResult& verified) {
    return json::parse(verified.out)["head_hash"];
  };
  EXPECT_EQ(hash(run_cairn({"verify", "--data", file("again"), "--json"})),
            hash(run({"verify", "--json"})));
  const auto twice = run_cairn({"restore", file("backups"), "--data", file("again")});
  EXPECT_EQ(twice.exit_code, 2);
  EXPECT_THAT(twice.err, HasSubstr("restore into a new folder"));
  EXPECT_EQ(run_cairn({"restore", file("nothing"), "--data", file("other")}).exit_code, 3);
  EXPECT_FALSE(std::filesystem::exists(file("other")));
}

TEST(Export, KeepsTheIdsOfFilesWhereTheyAreUnique) {
  const TemporaryFolder folder;
  {
    DataFolderMaker maker(folder.file("data"));
    const auto pose = [](const std::string& robot, std::uint64_t epoch, std::uint64_t index) {
      Transaction step;
      step.variables.push_back(
          {{{robot, epoch}, index}, VariableType::kPose2, {1.0 * index, 2.0, 0.5}, 0, {}});
      return step;
    };
    maker.submit(pose("a", 0, 1), "a");
    maker.submit(pose("a", 0, 40), "a");
    maker.submit(pose("b", 0, 1), "b");
    maker.submit(pose("c, the third", 99, 40), "c");
    Transaction stamped = pose("c, the third", 99, 50);
    stamped.variables.front().stamp_ns = 1'500'000'000;
    maker.submit(stamped, "c");
  }
  const auto run = [&](std::vector<std::string> words) {
    words.insert(words.end(), {"--data", folder.file("data"), "--live"});
    return run_cairn(words);
  };
  ASSERT_EQ(run({"export", "graph", folder.file("o.g2o")}).exit_code, 0);
  EXPECT_EQ(read_file(folder.file("o.ids.csv")),
            "id,robot,epoch,index\n0,a,0,1\n40,a,0,40\n1,b,0,1\n2,\"c, the third\",99,40\n3,\"c, "
            "the third\",99,50\n");
  ASSERT_EQ(run({"export", "trajectory", folder.file("o.tum")}).exit_code, 0);
  EXPECT_THAT(read_file(folder.file("o-b.tum")), testing::StartsWith("1 1 2 0 0 0 0.247"));
  EXPECT_EQ(lines_of(read_file(folder.file("o-c, the third.tum"))).size(), 2u);
  EXPECT_EQ(run({"export", "trajectory", "-"}).exit_code, 2);
  EXPECT_THAT(run({"export", "trajectory", "-", "--robot", "a"}).out, HasSubstr("\n40 40 2 0 "));
  EXPECT_THAT(run({"export", "trajectory", "-", "--robot", "z"}).err,
              HasSubstr("there are: a, b, c, the third"));
}

TEST(Export, RefusesAnEmptyMapAndWritesNothing) {
  const TemporaryFolder folder;
  { DataFolderMaker maker(folder.file("data")); }
  const auto exported =
      run_cairn({"export", "graph", folder.file("o.g2o"), "--data", folder.file("data")});
  EXPECT_EQ(exported.exit_code, 4);
  EXPECT_THAT(exported.err, HasSubstr("nothing to export"));
  EXPECT_EQ(folder.file_count(), 1u);
}

}  // namespace
