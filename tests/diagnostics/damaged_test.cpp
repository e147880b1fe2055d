// SPDX-License-Identifier: BSD-3-Clause
// Public graphs, whole and damaged on purpose.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "cairn/diagnostics/conventions.hpp"
#include "cairn/diagnostics/lint.hpp"
#include "cairn/solver/optimize.hpp"
#include "tests/diagnostics/lint_support.hpp"
#include "tests/support/datasets.hpp"

namespace cairn {
namespace {

using Fields = std::vector<std::string>;

// Every line, split at blanks, handed to `change` and put together again.
std::string with_lines(const std::string& text,
                       const std::function<void(std::size_t line, Fields&)>& change) {
  std::istringstream in(text);
  std::string line, result;
  for (std::size_t n = 1; std::getline(in, line); ++n) {
    std::istringstream fields_in(line);
    Fields fields;
    for (std::string field; fields_in >> field;) fields.push_back(field);
    change(n, fields);
    for (std::size_t k = 0; k < fields.size(); ++k) result += (k ? " " : "") + fields[k];
    result += '\n';
  }
  return result;
}

bool is_edge(const Fields& fields) { return !fields.empty() && fields[0].starts_with("EDGE"); }

void scale(std::string& field, double factor) { field = std::to_string(std::stod(field) * factor); }

double chi2_of(const std::string& text) {
  const auto document = read_graph_text(text, "x");
  EXPECT_TRUE(document) << document.error().to_string();
  return document ? compute_chi2(document->graph) : std::nan("");
}

std::set<std::string> codes(const LintReport& report) {
  std::set<std::string> names;
  for (const auto& [code, count] : report.counts) names.insert(to_string(code));
  return names;
}

constexpr double kDegreesPerRad = 180.0 / std::numbers::pi;
const LintOptions kNoSolve{.solve = false};

class PublicGraph : public testing::TestWithParam<const char*> {};

TEST_P(PublicGraph, HasNoErrors) {
  CAIRN_REQUIRE_DATASET(path, std::string("graphs/") + GetParam());
  const LintReport report = lint_graph_text(test::read_file(path), GetParam(), kNoSolve);
  EXPECT_EQ(report.errors, 0u) << test::messages(report);
}

INSTANTIATE_TEST_SUITE_P(
    Lint, PublicGraph,
    testing::Values("pose2/intel.g2o", "pose2/manhattan.g2o", "pose2/CSAIL.g2o",
                    "pose2/city10000.g2o", "pose2/kitti_00.g2o", "pose2/M3500a.g2o",
                    "pose3/sphere2500.g2o", "pose3/sphere_bignoise_vertex3.g2o",
                    "pose3/parking-garage.g2o", "pose3/smallGrid3D.g2o", "pose3/tinyGrid3D.g2o",
                    "toro/CSAIL_P_toro.graph", "toro/FR079_P_toro.graph",
                    "toro/sphere_smallnoise.graph", "toro/w100.graph", "landmarks/victoriaPark.txt",
                    "truth/sphere.g2o", "outliers/bicocca/B25b_0.000.g2o",
                    "outliers/vertigo_ringCity/originalDataset/ringCity.g2o",
                    "multirobot/argos_clean_4robots/0.g2o", "multirobot/blocks_4robots/3.g2o"));

TEST(DamagedGraph, DecimalCommasAreRepairedToTheSameGraph) {
  CAIRN_REQUIRE_DATASET(path, "graphs/pose2/intel.g2o");
  const std::string text = test::read_file(path);
  std::string damaged = text;
  std::replace(damaged.begin(), damaged.end(), '.', ',');
  EXPECT_THAT(codes(lint_graph_text(damaged, "x", kNoSolve)), testing::Contains("CHK006"));
  const RepairedText repaired = repair_graph_text(damaged, "x", kNoSolve);
  EXPECT_TRUE(repaired.after.clean()) << test::messages(repaired.after);
  EXPECT_EQ(chi2_of(repaired.text), chi2_of(text));
}

TEST(DamagedGraph, TorosOrderInG2oIsRepairedToTheSameGraph) {
  CAIRN_REQUIRE_DATASET(path, "graphs/pose2/intel.g2o");
  const std::string text = test::read_file(path);
  const std::string damaged = with_lines(text, [](std::size_t, Fields& f) {
    if (is_edge(f)) f = {f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7], f[9], f[11], f[8], f[10]};
  });
  EXPECT_THAT(codes(lint_graph_text(damaged, "x", kNoSolve)), testing::Contains("CHK013"));
  const RepairedText repaired = repair_graph_text(damaged, "x", kNoSolve);
  EXPECT_TRUE(repaired.after.clean()) << test::messages(repaired.after);
  EXPECT_EQ(chi2_of(repaired.text), chi2_of(text));
}

TEST(DamagedGraph, G2osOrderInToroIsRepairedToTheSameGraph) {
  CAIRN_REQUIRE_DATASET(path, "graphs/toro/FR079_P_toro.graph");
  const std::string text = test::read_file(path);
  const std::string damaged = with_lines(text, [](std::size_t, Fields& f) {
    if (is_edge(f)) f = {f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7], f[10], f[8], f[11], f[9]};
  });
  const RepairedText repaired = repair_graph_text(damaged, "x", kNoSolve);
  EXPECT_THAT(codes(repaired.before), testing::Contains("CHK013"));
  EXPECT_TRUE(repaired.after.clean()) << test::messages(repaired.after);
  EXPECT_EQ(chi2_of(repaired.text), chi2_of(text));
}

TEST(DamagedGraph, DegreesAreFoundInEdgesVerticesAndBoth) {
  CAIRN_REQUIRE_DATASET(path, "graphs/pose2/intel.g2o");
  const std::string text = test::read_file(path);
  for (const bool vertices : {false, true}) {
    for (const bool edges : {false, true}) {
      const std::string damaged = with_lines(text, [&](std::size_t, Fields& f) {
        if (edges && is_edge(f)) scale(f[5], kDegreesPerRad);
        if (vertices && f[0] == "VERTEX_SE2") scale(f[4], kDegreesPerRad);
      });
      const bool found = codes(lint_graph_text(damaged, "x", kNoSolve)).contains("CHK016");
      EXPECT_EQ(found, vertices || edges) << "vertices " << vertices << ", edges " << edges;
    }
  }
}

TEST(DamagedGraph, DegreesAreFoundInAFileWithEdgesOnly) {
  CAIRN_REQUIRE_DATASET(path, "graphs/pose2/manhattan.g2o");
  const std::string damaged = with_lines(test::read_file(path), [](std::size_t, Fields& f) {
    if (is_edge(f)) scale(f[5], kDegreesPerRad);
  });
  EXPECT_THAT(codes(lint_graph_text(damaged, "x", kNoSolve)), testing::Contains("CHK016"));
}

TEST(DamagedGraph, DegreesAreFoundInRollPitchYaw) {
  CAIRN_REQUIRE_DATASET(path, "graphs/toro/sphere_smallnoise.graph");
  const std::string damaged = with_lines(test::read_file(path), [](std::size_t, Fields& f) {
    if (!is_edge(f)) return;
    for (std::size_t k = 6; k < 9; ++k) scale(f[k], kDegreesPerRad);
  });
  EXPECT_THAT(codes(lint_graph_text(damaged, "x", kNoSolve)), testing::Contains("CHK016"));
}

TEST(DamagedGraph, QuaternionsWithWFirstAreFound) {
  CAIRN_REQUIRE_DATASET(path, "graphs/pose3/sphere2500.g2o");
  const std::string damaged = with_lines(test::read_file(path), [](std::size_t, Fields& f) {
    const std::size_t q = is_edge(f) ? 6 : 5;
    std::rotate(f.begin() + static_cast<long>(q), f.begin() + static_cast<long>(q) + 3,
                f.begin() + static_cast<long>(q) + 4);
  });
  EXPECT_THAT(codes(lint_graph_text(damaged, "x", kNoSolve)), testing::Contains("CHK017"));
}

TEST(DamagedGraph, UnnormalizedQuaternionsAreRepairedToTheSameGraph) {
  CAIRN_REQUIRE_DATASET(path, "graphs/pose3/smallGrid3D.g2o");
  const std::string text = test::read_file(path);
  const std::string damaged = with_lines(text, [](std::size_t line, Fields& f) {
    for (std::size_t k = is_edge(f) ? 6 : 5; k < (is_edge(f) ? 10u : 9u); ++k) {
      if (line % 3 == 0) scale(f[k], 2.0);
    }
  });
  const RepairedText repaired = repair_graph_text(damaged, "x", kNoSolve);
  EXPECT_THAT(codes(repaired.before), testing::Contains("CHK011"));
  EXPECT_THAT(codes(repaired.after), testing::Not(testing::Contains("CHK011")));
  EXPECT_NEAR(chi2_of(repaired.text) / chi2_of(text), 1.0, 1e-3);  // six decimals were written
}

TEST(DamagedGraph, WrongScaleIsFoundWithTheFactorThatMendsIt) {
  CAIRN_REQUIRE_DATASET(path, "graphs/pose2/M3500a.g2o");
  const std::string text = test::read_file(path);
  EXPECT_THAT(codes(lint_graph_text(text, "x")), testing::Not(testing::Contains("CHK035")));
  const std::string damaged = with_lines(text, [](std::size_t, Fields& f) {
    for (std::size_t k = 6; is_edge(f) && k < 12; ++k) scale(f[k], 1e6);
  });
  EXPECT_THAT(codes(lint_graph_text(damaged, "x")), testing::Contains("CHK035"));
}

TEST(DamagedGraph, ManyFaultsAtOnceAreRepairedAndTheResultOptimizes) {
  CAIRN_REQUIRE_DATASET(path, "graphs/pose2/intel.g2o");
  std::string damaged = with_lines(test::read_file(path), [](std::size_t line, Fields& f) {
    if (line == 100) f[3] = "nan";        // a vertex
    if (line == 200) f[2] = "1,5e0";      // a vertex
    if (line == 1800) f[8] = "inf";       // an edge
    if (line == 1900) f[3] = f[3] + "x";  // stays
    if (line == 2000) f.insert(f.end(), f.begin() + 6, f.end()), f.resize(12);
  });
  damaged += "EDGE_SE2 7 7 1 0 0 1 0 0 1 0 1\nEDGE_SE2 7 900000 1 0 0 1 0 0 1 0 1\nFIX 123456789\n";
  const RepairedText repaired = repair_graph_text(damaged, "x", kNoSolve);
  EXPECT_EQ(test::places(repaired.after).size(),
            repaired.after.errors + repaired.after.notes + repaired.after.warnings);
  EXPECT_EQ(repaired.after.errors, 1u) << test::messages(repaired.after);
  const std::string mended = with_lines(repaired.text, [](std::size_t line, Fields& f) {
    if (line == 1900) f[3].pop_back();
  });
  auto document = read_graph_text(mended, "x");
  ASSERT_TRUE(document) << document.error().to_string();
  const SolveSummary summary = optimize(document->graph, {.init = InitMethod::kAuto});
  EXPECT_TRUE(summary.usable());
  // One edge of 2512 is gone: chi2 can only be smaller than the optimum of the whole
  // graph, 45.0047.
  EXPECT_LE(summary.final_chi2, 45.005);
}

}  // namespace
}  // namespace cairn
