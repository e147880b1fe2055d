// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cairn/io/graph_file.hpp"
#include "cairn/solver/optimize.hpp"
#include "datasets/simulate.hpp"
#include "tests/support/process.hpp"

namespace {

using namespace cairn;
using namespace cairn::test;
using testing::HasSubstr;

double chi2_of(const std::string& path) {
  const auto document = read_graph(path);
  EXPECT_TRUE(document) << document.error().to_string();
  return document ? compute_chi2(document->graph) : -1.0;
}

TEST(SimulateVerb, WritesEveryWorldAndItsTruthSoThatTheyReadBackTheSame) {
  for (const std::string& name : world_names()) {
    const TemporaryFolder folder;
    const std::string noisy = folder.file("noisy.g2o"), truth = folder.file("truth.g2o");
    const auto run = run_cairn({"simulate", name, "--poses", "120", "-o", noisy, "--truth", truth});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr(name + ": "));
    const auto world = simulate({.world = *find_world(name), .poses = 120});
    // Shortest round-trip digits; the sum runs over the batches in another order.
    EXPECT_NEAR(chi2_of(noisy) / compute_chi2(world->graph), 1.0, 1e-9) << name;
    EXPECT_NEAR(chi2_of(truth) / compute_chi2(world->true_graph()), 1.0, 1e-9) << name;
  }
}

TEST(SimulateVerb, WritesEverySensorSoThatItReadsBackTheSame) {
  for (const std::string& name : sensor_names()) {
    const TemporaryFolder folder;
    const std::string truth = folder.file("truth.g2o");
    const auto run = run_cairn({"simulate", "landmarks", "--sensor", name, "--poses", "120", "-o",
                                folder.file("noisy.g2o"), "--truth", truth});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    const auto world =
        simulate({.world = World::kLandmarks, .poses = 120, .sensor = *find_sensor(name)});
    EXPECT_NEAR(chi2_of(truth) / compute_chi2(world->true_graph()), 1.0, 1e-9) << name;
  }
}

TEST(SimulateVerb, WritesTheGraphToStandardOutputAndTheSummaryBesideIt) {
  const auto run = run_cairn({"simulate", "manhattan", "--poses", "20", "-o", "-"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, testing::StartsWith("VERTEX_SE2 0 "));
  EXPECT_THAT(run.err, HasSubstr("manhattan: 20 variables"));
}

TEST(SimulateVerb, RefusesWhatItCannotDoWithUsageErrors) {
  EXPECT_EQ(run_cairn({"simulate", "atlantis", "-o", "/dev/null"}).exit_code, 2);
  EXPECT_EQ(run_cairn({"simulate", "city"}).exit_code, 2);
  EXPECT_EQ(run_cairn({"simulate", "city", "--poses", "1", "-o", "/dev/null"}).exit_code, 2);
  EXPECT_EQ(run_cairn({"simulate", "city", "--poses", "-5", "-o", "/dev/null"}).exit_code, 2);
  EXPECT_EQ(run_cairn({"simulate", "city", "--noise", "nan", "-o", "/dev/null"}).exit_code, 2);
  EXPECT_EQ(run_cairn({"simulate", "city", "-o", "/nonexistent/x.g2o"}).exit_code, 2);
  EXPECT_EQ(run_cairn({"simulate", "city", "-o", "-", "--truth", "-"}).exit_code, 2);
}

}  // namespace
