// SPDX-License-Identifier: BSD-3-Clause
// Public graphs in every format: what is read is what is written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cairn/io/graph_file.hpp"
#include "cairn/solver/optimize.hpp"
#include "tests/support/datasets.hpp"

namespace cairn {
namespace {

GraphDocument read(std::string_view text) {
  Result<GraphDocument> document = read_graph_text(text, "again");
  EXPECT_TRUE(document) << document.error().to_string();
  return document ? std::move(*document) : GraphDocument{};
}

std::string write(const GraphDocument& document, GraphFormat format) {
  Result<std::string> text = write_graph_text(document, format);
  EXPECT_TRUE(text) << text.error().to_string();
  return text ? *text : "";
}

struct PublicGraph {
  const char* path;
  std::size_t variables, factors;
};
void PrintTo(const PublicGraph& graph, std::ostream* out) { *out << graph.path; }

class PublicGraphs : public testing::TestWithParam<PublicGraph> {};

TEST_P(PublicGraphs, SurviveARoundTripWithTheSameChi2) {
  CAIRN_REQUIRE_DATASET(path, std::string("graphs/") + GetParam().path);
  const auto document = read_graph(path);
  ASSERT_TRUE(document) << document.error().to_string();
  // w100 has 60 edges between ids that its EQUIV lines make one.
  EXPECT_EQ(document->warnings.size(), document->equivalences.empty() ? 0u : 1u);
  EXPECT_EQ(document->graph.variables().size(), GetParam().variables);
  EXPECT_EQ(document->graph.factor_count(), GetParam().factors);
  const double chi2 = compute_chi2(document->graph);
  const GraphFormat format =
      document->format == GraphFormat::kDlr ? GraphFormat::kG2o : document->format;
  const std::string first = write(*document, format);
  const GraphDocument again = read(first);
  if (format != GraphFormat::kIsam || document->format == GraphFormat::kIsam) {
    EXPECT_NEAR(compute_chi2(again.graph), chi2, 1e-9 * chi2);
  }
  const std::string second = write(again, format);
  EXPECT_TRUE(write(read(second), format) == second) << "the text does not stand still";
  const GraphDocument as_g2o = read(write(*document, GraphFormat::kG2o));
  EXPECT_NEAR(compute_chi2(as_g2o.graph), chi2, 1e-9 * chi2);
}

INSTANTIATE_TEST_SUITE_P(
    All, PublicGraphs,
    testing::Values(
        PublicGraph{"pose2/intel.g2o", 1728, 2512}, PublicGraph{"pose2/manhattan.g2o", 3500, 5453},
        PublicGraph{"pose2/CSAIL.g2o", 1045, 1172},
        PublicGraph{"pose2/city10000.g2o", 10000, 20687},
        PublicGraph{"pose2/kitti_00.g2o", 4541, 4677}, PublicGraph{"pose2/M3500a.g2o", 3500, 5453},
        PublicGraph{"pose3/sphere2500.g2o", 2500, 4949},
        PublicGraph{"pose3/sphere_bignoise_vertex3.g2o", 2200, 8647},
        PublicGraph{"pose3/parking-garage.g2o", 1661, 6275},
        PublicGraph{"pose3/smallGrid3D.g2o", 125, 297}, PublicGraph{"pose3/tinyGrid3D.g2o", 9, 11},
        PublicGraph{"toro/CSAIL_P_toro.graph", 1045, 1172},
        PublicGraph{"toro/FR079_P_toro.graph", 989, 1217}, PublicGraph{"toro/w100.graph", 60, 240},
        PublicGraph{"toro/sphere_smallnoise.graph", 2200, 8647},
        PublicGraph{"landmarks/victoriaPark.txt", 7120, 10608},
        PublicGraph{"landmarks/dlr", 3873, 17605}, PublicGraph{"truth/sphere.g2o", 2500, 9799},
        PublicGraph{"truth/sphere_gt.g2o", 2500, 9799},
        PublicGraph{"outliers/bicocca/B25b_0.500.g2o", 8358, 8479},
        PublicGraph{"outliers/vertigo_ringCity/originalDataset/ringCity.g2o", 2361, 3261}));

TEST(PublicGraphs, OfFourRobotsMergeIntoOneWithoutCopies) {
  CAIRN_REQUIRE_DATASET(folder, "graphs/multirobot/argos_clean_4robots");
  std::vector<std::string> paths;
  std::size_t in_files = 0;
  for (int robot = 0; robot < 4; ++robot) {
    paths.push_back(folder + "/" + std::to_string(robot) + ".g2o");
    const auto alone = read_graph(paths.back());
    ASSERT_TRUE(alone) << alone.error().to_string();
    EXPECT_THAT(alone->warnings, testing::ElementsAre(testing::HasSubstr("no line")))
        << "of the others' vertices";
    in_files += alone->graph.factor_count();
  }
  const auto merged = read_graphs(paths);
  ASSERT_TRUE(merged) << merged.error().to_string();
  EXPECT_THAT(merged->warnings, testing::IsEmpty());
  EXPECT_EQ(merged->graph.variables().size(), 440u);
  EXPECT_EQ(in_files, 597u);
  EXPECT_EQ(merged->graph.factor_count(), 519u)
      << "78 of the edges between robots are in two files";
}

TEST(PublicGraphs, AreReadFromCompressedFiles) {
  CAIRN_REQUIRE_DATASET(path, "graphs/pose3/tinyGrid3D.g2o");
  const auto document = read_graph(path);
  ASSERT_TRUE(document);
  for (const char* ending : {".gz", ".bz2"}) {
    const std::string packed = testing::TempDir() + "cairn_tiny.g2o" + ending;
    ASSERT_TRUE(write_graph(*document, packed, GraphFormat::kG2o));
    const auto again = read_graph(packed);
    ASSERT_TRUE(again) << again.error().to_string();
    EXPECT_EQ(write(*again, GraphFormat::kG2o), write(*document, GraphFormat::kG2o));
    std::filesystem::remove(packed);
  }
}

}  // namespace
}  // namespace cairn
