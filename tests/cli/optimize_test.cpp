// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/support/picture_files.hpp"
#include "tests/support/process.hpp"

namespace {

using namespace cairn::test;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// A square whose last edge closes the loop, with a start that is off.
constexpr const char* kSquare = R"(VERTEX_SE2 0 0 0 0
VERTEX_SE2 1 1.1 0 1.6
VERTEX_SE2 2 1.0 1.2 3.1
VERTEX_SE2 3 -0.1 1.1 -1.5
EDGE_SE2 0 1 1 0 1.5707963 100 0 0 100 0 100
EDGE_SE2 1 2 1 0 1.5707963 100 0 0 100 0 100
EDGE_SE2 2 3 1 0 1.5707963 100 0 0 100 0 100
EDGE_SE2 3 0 1 0.1 1.5707963 100 0 0 100 0 100
)";
constexpr const char* kBroken = "VERTEX_SE2 0 0 0 0\nEDGE_SE2 0 1 1 nonsense 0 1 0 0 1 0 1\n";
// A landmark of which only the distance to one pose is known.
constexpr const char* kUndetermined = R"(VERTEX_SE2 0 0 0 0
VERTEX_SE2 1 1 0 0
VERTEX_XY 2 2 0.5
EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1
EDGE_CAIRN_RANGE 1 2 1 1
)";

// A walk in circles that recognizes the place of one lap ago at every step.
std::string spiral(int poses) {
  constexpr int kLap = 40;
  std::string text;
  for (int i = 0; i < poses; ++i) text += "VERTEX_SE2 " + std::to_string(i) + " 0 0 0\n";
  const auto edge = [&](int a, int b, const std::string& pose) {
    text += "EDGE_SE2 " + std::to_string(a) + " " + std::to_string(b) + " " + pose +
            " 100 0 0 100 0 100\n";
  };
  for (int i = 1; i < poses; ++i) edge(i - 1, i, "1 0 0.15707963");
  for (int i = kLap; i < poses; ++i) edge(i - kLap, i, i % 2 == 0 ? "0.01 0 0" : "0 0.02 0.01");
  return text;
}

class Optimize : public testing::Test {
 protected:
  std::string square() const { return folder_.write("square.g2o", kSquare); }
  std::string file(const std::string& name) const { return folder_.file(name); }
  bool exists(const std::string& name) const { return std::filesystem::exists(file(name)); }

  TemporaryFolder folder_;
};

TEST_F(Optimize, LeavesOutFalseLoopsWhereItIsAskedTo) {
  ASSERT_EQ(run_cairn({"simulate", "city", "--poses", "400", "--outliers", "0.05", "--seed", "2",
                       "-o", file("city.g2o")})
                .exit_code,
            0);
  const auto run = run_cairn({"optimize", file("city.g2o"), "--gate", "--json", file("report.json"),
                              "-o", file("out.g2o")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto report = nlohmann::json::parse(read_file(file("report.json")));
  const auto& left_out = report["gate"]["left_out"];
  EXPECT_GT(left_out.size(), 5u);
  EXPECT_THAT(run.out, HasSubstr(std::to_string(left_out.size()) + " of " +
                                 std::to_string(report["gate"]["loops"].get<int>()) +
                                 " loop closures left out: "));
  EXPECT_GT(left_out[0]["value"], left_out[0]["threshold"]);
  EXPECT_LT(report["final_chi2"], 2.0 * report["dof"].get<double>());
  const auto again = run_cairn({"optimize", file("out.g2o"), "--json", "-"});
  const auto rest = nlohmann::json::parse(again.out);
  EXPECT_EQ(rest["edges"].get<std::size_t>() + left_out.size(), report["edges"]);
  EXPECT_NEAR(rest["final_chi2"], report["final_chi2"].get<double>(),
              1e-6 * report["dof"].get<double>());
  const auto both = run_cairn({"optimize", file("city.g2o"), "--gate", "--loss", "huber"});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_THAT(both.err, HasSubstr("choose --gate or --loss"));
}

TEST_F(Optimize, WritesTheOptimumAndSaysWhatItDid) {
  const auto run = run_cairn({"optimize", square(), "-o", file("out.g2o")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(read_file(file("out.g2o")), HasSubstr("VERTEX_SE2 3 "));
  EXPECT_THAT(run.out, HasSubstr("converged"));
  EXPECT_THAT(run.out, Not(HasSubstr("\x1b"))) << "no progress line in a pipe";
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_EQ(folder_.file_count(), 2u);
}

TEST_F(Optimize, QuietSaysNothing) {
  const auto run = run_cairn({"optimize", square(), "--quiet"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out + run.err, IsEmpty());
}

TEST_F(Optimize, PipesTheGraphAndSpeaksOnStandardError) {
  const auto run = run_cairn({"optimize", "-", "-o", "-"}, kSquare);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, testing::StartsWith("VERTEX_SE2 0 "));
  EXPECT_THAT(run.err, HasSubstr("converged"));
}

TEST_F(Optimize, ReportHasEveryKeyAndNullWhereNothingIsKnown) {
  const auto run = run_cairn({"optimize", square(), "--json", "-"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto report = nlohmann::json::parse(run.out);
  for (const char* key : {"schema_version", "input",
                          "vertices",       "edges",
                          "components",     "dof",
                          "error_chart",    "input_chi2",
                          "initialization", "initial_chi2",
                          "final_chi2",     "final_cost",
                          "status",         "stop_reason",
                          "usable",         "under_constrained",
                          "iterations",     "setup_s",
                          "optimize_s",     "read_s",
                          "write_s",        "peak_rss_bytes",
                          "threads",        "linear",
                          "ordering",       "factor_nnz"}) {
    EXPECT_TRUE(report.contains(key)) << key;
  }
  EXPECT_EQ(report["vertices"], 4);
  EXPECT_EQ(report["edges"], 4);
  EXPECT_EQ(report["dof"], 3);
  EXPECT_EQ(report["components"], 1);
  EXPECT_EQ(report["error_chart"], "g2o");
  EXPECT_EQ(report["status"], "converged");
  EXPECT_TRUE(report["usable"]);
  EXPECT_TRUE(report["write_s"].is_null()) << "no graph was written";
  EXPECT_GT(report["input_chi2"], report["final_chi2"]);
  EXPECT_NEAR(report["final_cost"].get<double>(), report["final_chi2"].get<double>() / 2, 1e-9);
  EXPECT_GT(report["peak_rss_bytes"], 1'000'000);
  ASSERT_FALSE(report["iterations"].empty());
  for (const char* key :
       {"chi2", "lambda", "accepted", "linearize_s", "factorize_s", "solve_s", "total_s"}) {
    EXPECT_TRUE(report["iterations"][0].contains(key)) << key;
  }
  EXPECT_TRUE(report["initialization"].contains("chosen"));
  ASSERT_FALSE(report["initialization"]["candidates"].empty());
  for (const char* key : {"name", "chi2", "seconds"}) {
    EXPECT_TRUE(report["initialization"]["candidates"][0].contains(key)) << key;
  }
}

TEST_F(Optimize, InputChi2IsNullWithoutVertices) {
  const std::string edges(std::string(kSquare).substr(std::string(kSquare).find("EDGE_SE2")));
  const auto run = run_cairn({"optimize", "-", "--json", "-"}, edges);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(nlohmann::json::parse(run.out)["input_chi2"].is_null());
}

TEST_F(Optimize, RefusesBadUsageWithExitCode2) {
  const std::string in = square();
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"optimize"},
           {"optimize", in, "--nonsense"},
           {"optimize", in, "--method", "magic"},
           {"optimize", in, "--loss", "huber:-1"},
           {"optimize", in, "--loss", "unheard-of"},
           {"optimize", in, "--max-iterations", "-3"},
           {"optimize", in, "--plot", file("picture.jpg")},
           {"optimize", in, "-o", "-", "--json", "-"},
           {"optimize", in, "-o", file("same"), "--json", file("same")},
           {"optimize", in, "-o", "/nowhere/out.g2o"},
           {"optimize", "-", "-"},
           {}}) {
    const auto run = run_cairn(arguments, kSquare);
    EXPECT_EQ(run.exit_code, 2) << testing::PrintToString(arguments) << run.out << run.err;
    EXPECT_THAT(run.err, Not(IsEmpty()));
  }
  EXPECT_EQ(folder_.file_count(), 1u);
}

TEST_F(Optimize, BadInputIsNamedWithItsPlaceAndNothingIsWritten) {
  const std::string in = folder_.write("broken.g2o", kBroken);
  const auto run = run_cairn({"optimize", in, "-o", file("out.g2o"), "--json", file("r.json"),
                              "--plot", file("p.svg"), "--covariances", file("c.csv")});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_THAT(run.err, HasSubstr("broken.g2o:2:"));
  EXPECT_EQ(folder_.file_count(), 1u);
  EXPECT_EQ(run_cairn({"optimize", file("missing.g2o")}).exit_code, 3);
  EXPECT_EQ(run_cairn({"optimize", "-"}, "").exit_code, 3);
}

TEST_F(Optimize, NotUsableWritesTheReportOnly) {
  const auto run = run_cairn({"optimize", square(), "--init", "file", "--max-iterations", "0", "-o",
                              file("out.g2o"), "--json", file("r.json"), "--plot", file("p.png"),
                              "--covariances", file("c.csv")});
  EXPECT_EQ(run.exit_code, 4) << run.out << run.err;
  EXPECT_THAT(run.err, HasSubstr("iteration_limit"));
  const auto report = nlohmann::json::parse(read_file(file("r.json")));
  EXPECT_FALSE(report["usable"]);
  EXPECT_EQ(report["stop_reason"], "iteration_limit");
  EXPECT_EQ(folder_.file_count(), 2u);
}

TEST_F(Optimize, StrictRefusesUnknownTags) {
  const std::string unknown =
      folder_.write("unknown.g2o", std::string(kSquare) + "MYSTERY 1 2 3\n");
  const auto lenient = run_cairn({"optimize", unknown});
  EXPECT_EQ(lenient.exit_code, 0) << lenient.err;
  EXPECT_THAT(lenient.err, HasSubstr("unknown.g2o:9:"));
  EXPECT_EQ(run_cairn({"optimize", unknown, "--strict"}).exit_code, 3);
}

TEST_F(Optimize, NamesUndeterminedVariablesAndStrictRefusesThem) {
  const std::string free = folder_.write("free.g2o", kUndetermined);
  const auto partial = run_cairn({"optimize", free, "--json", file("r.json")});
  EXPECT_EQ(partial.exit_code, 0) << partial.err;
  EXPECT_THAT(partial.err, HasSubstr("not determined"));
  const auto report = nlohmann::json::parse(read_file(file("r.json")));
  EXPECT_EQ(report["status"], "partially_constrained");
  ASSERT_EQ(report["under_constrained"].size(), 1u);
  EXPECT_EQ(report["under_constrained"][0]["id"], 2);
  EXPECT_EQ(report["under_constrained"][0]["free_directions"][0].size(), 2u);
  EXPECT_EQ(run_cairn({"optimize", free, "--strict"}).exit_code, 4);
}

TEST_F(Optimize, MergesSeveralInputs) {
  const std::string more =
      folder_.write("more.g2o", "VERTEX_SE2 4 0 0 0\nEDGE_SE2 3 4 1 0 0 1 0 0 1 0 1\n");
  const auto run = run_cairn({"optimize", square(), more, "--json", "-"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(nlohmann::json::parse(run.out)["vertices"], 5);
}

TEST_F(Optimize, OutputFormatFollowsToThenExtension) {
  EXPECT_EQ(run_cairn({"optimize", square(), "-o", file("out.graph")}).exit_code, 0);
  EXPECT_THAT(read_file(file("out.graph")), HasSubstr("VERTEX2 "));
  EXPECT_EQ(run_cairn({"optimize", square(), "-o", file("b.graph"), "--to", "g2o"}).exit_code, 0);
  EXPECT_THAT(read_file(file("b.graph")), HasSubstr("VERTEX_SE2 "));
}

TEST_F(Optimize, CovariancesAreOneLinePerVariable) {
  const auto run = run_cairn({"optimize", square(), "--covariances", "-"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), 4);
  EXPECT_THAT(run.out, HasSubstr("\n1,3,"));
  EXPECT_EQ(std::count(run.out.begin(), run.out.end(), ','), 4 * (1 + 6));
}

TEST_F(Optimize, DrawsBeforeAndAfterWithTheTruth) {
  const std::string in = square();
  const auto run =
      run_cairn({"optimize", "--plot", file("p.png"), "--plot", file("p.svg"), in, "--truth", in});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("ATE"));
  EXPECT_EQ(png_size(read_file(file("p.png"))), std::pair(1600, 900));
  EXPECT_TRUE(is_well_formed_svg(read_file(file("p.svg"))));
}

TEST_F(Optimize, InterruptStopsWithItsReason) {
  // Whether the signal comes during the solve or after it is up to the machine, so only what must
  // hold in each case is checked.
  const std::string in = folder_.write("spiral.g2o", spiral(20'000));
  Process process(cairn_command({"optimize", in, "-o", file("out.g2o"), "--json", file("r.json")}));
  while (process.out().find("input:") == std::string::npos) usleep(1000);
  process.send(SIGINT);
  const auto run = process.wait();
  ASSERT_TRUE(run.exit_code == 0 || run.exit_code == 4) << run.exit_code << run.err;
  EXPECT_EQ(exists("out.g2o"), run.exit_code == 0);
  if (run.exit_code == 4) {
    EXPECT_EQ(nlohmann::json::parse(read_file(file("r.json")))["stop_reason"], "interrupted");
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder_.file(""))) {
    EXPECT_THAT(entry.path().string(), Not(HasSubstr(".tmp")));
  }
}

}  // namespace
