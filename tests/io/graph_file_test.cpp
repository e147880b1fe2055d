// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/graph_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "cairn/factors/between.hpp"
#include "cairn/factors/landmark_xy.hpp"
#include "cairn/solver/optimize.hpp"

namespace cairn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

GraphDocument read(std::string_view text, const ReadOptions& options = {}) {
  Result<GraphDocument> document = read_graph_text(text, "f", options);
  EXPECT_TRUE(document) << document.error().to_string();
  return document ? std::move(*document) : GraphDocument{};
}

std::string write(const GraphDocument& document, GraphFormat format) {
  Result<std::string> text = write_graph_text(document, format);
  EXPECT_TRUE(text) << text.error().to_string();
  return text ? *text : "";
}

VariableSlot slot(const GraphDocument& document, std::uint64_t id) {
  const auto found = document.graph.find(VariableId{id});
  EXPECT_TRUE(found) << id;
  return found.value_or(0);
}

Se2 pose2(const GraphDocument& document, std::uint64_t id) {
  return document.graph.values().pose2[document.graph.variables()[slot(document, id)].index];
}

constexpr std::string_view kTwoPoses = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0.5\n";

TEST(ReadGraph, TakesLinesInAnyOrder) {
  const GraphDocument d = read(
      "FIX 1 0\n"
      "EDGE_SE2 1 0 -1 0.1 0 1 0 0 1 0 1\n"
      "VERTEX_SE2 1 1 0 0\n"
      "VERTEX_SE2 0 0 0 0\n");
  EXPECT_EQ(d.graph.factor_count(), 1u);
  EXPECT_TRUE(d.graph.variables()[slot(d, 0)].fixed);
  EXPECT_TRUE(d.graph.variables()[slot(d, 1)].fixed);
  EXPECT_NEAR(compute_chi2(d.graph), 0.01, 1e-15);
}

TEST(ReadGraph, TakesCarriageReturnsCommentsAndIdsOf64Bits) {
  const GraphDocument d = read(
      "# a comment\r\n\r\nVERTEX_SE2 18446744073709551615 1 2 8.85e+000 # here\r\n"
      "VERTEX_SE2 0 0 0 0");
  EXPECT_EQ(pose2(d, ~std::uint64_t{0}).x(), 1.0);
  EXPECT_NEAR(pose2(d, ~std::uint64_t{0}).theta(), 8.85 - 2.0 * std::numbers::pi, 1e-14);
  EXPECT_TRUE(d.warnings.empty());
}

TEST(ReadGraph, ChainsEdgesWhereThereAreNoVertices) {
  const GraphDocument d = read(
      "EDGE_SE2 7 5 -1 0 0 1 0 0 1 0 1\n"
      "EDGE_SE2 7 9 0 2 0 1 0 0 1 0 1\n"
      "EDGE_SE2_XY 9 2 1 1 1 0 1\n"
      "EDGE_SE2 20 21 3 0 0 1 0 0 1 0 1\n");
  ASSERT_EQ(d.graph.variables().size(), 6u);
  EXPECT_THAT(d.has_start, testing::Each(false));
  EXPECT_EQ(d.graph.variables()[0].id.value, 2u) << "sorted by id";
  EXPECT_EQ(pose2(d, 5).x(), 0.0);
  EXPECT_EQ(pose2(d, 7).x(), 1.0);
  EXPECT_EQ(pose2(d, 9).y(), 2.0);
  EXPECT_EQ(pose2(d, 20).x(), 0.0) << "a component of its own";
  EXPECT_EQ(pose2(d, 21).x(), 3.0);
  const Variable& point = d.graph.variables()[slot(d, 2)];
  EXPECT_EQ(point.type, VariableType::kPoint2);
  EXPECT_EQ(d.graph.values().point2[point.index], Eigen::Vector2d(2.0, 3.0));
  EXPECT_NEAR(compute_chi2(d.graph), 0.0, 1e-30);
}

TEST(ReadGraph, ComputesTheStartOfARobotThatIsLeftOut) {
  const std::string other = std::to_string(std::uint64_t{98} << 56);
  const GraphDocument d =
      read(std::string(kTwoPoses) + "EDGE_SE2 1 " + other + " 2 0 0 1 0 0 1 0 1\n");
  EXPECT_FALSE(d.has_start[slot(d, std::uint64_t{98} << 56)]);
  EXPECT_TRUE(d.has_start[slot(d, 1)]);
  EXPECT_NEAR(pose2(d, std::uint64_t{98} << 56).x(), 1.0 + 2.0 * std::cos(0.5), 1e-15);
  EXPECT_THAT(d.warnings, ElementsAre(HasSubstr("f: 1 vertex has no line")));
}

TEST(ReadGraph, KeepsUnknownLinesAndSaysSo) {
  const std::string text =
      std::string(kTwoPoses) + "ROBOTLASER1 0 1.50 # kept\nROBOTLASER1 1\nMETA x\n";
  const GraphDocument d = read(text);
  EXPECT_THAT(d.unknown_lines, ElementsAre("ROBOTLASER1 0 1.50 # kept", "ROBOTLASER1 1", "META x"));
  EXPECT_THAT(d.warnings,
              ElementsAre("f:3:1: unknown tag ROBOTLASER1; 2 lines are kept as they are",
                          "f:5:1: unknown tag META; the line is kept as it is"));
  EXPECT_THAT(write(d, GraphFormat::kG2o),
              testing::EndsWith("ROBOTLASER1 0 1.50 # kept\nROBOTLASER1 1\nMETA x\n"));
  const auto strict = read_graph_text(text, "f", {.strict = true});
  ASSERT_FALSE(strict);
  EXPECT_EQ(strict.error().to_string(), "f:3:1: unknown tag ROBOTLASER1");
}

TEST(ReadGraph, RescalesSpatialInformationToRadiansAndBack) {
  std::string text = "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 0 0 0 0.6 0 0 0.8\n";
  text += "EDGE_SE3:QUAT 0 1 0 0 0 0 0 0 1 1 0 0 0.5 0 0 1 0 0 0 0 1 0 0 0 4 0 0 4 0 4\n";
  const GraphDocument d = read(text);
  const BetweenSe3& edge = d.graph.find_batch<BetweenSe3>()->factor(0);
  EXPECT_EQ(edge.information(3, 3), 1.0);
  EXPECT_EQ(edge.information(0, 3), 0.25);
  EXPECT_NEAR(compute_chi2(d.graph), 4.0 * 0.36, 1e-14) << "g2o's chi2";
  EXPECT_EQ(write(d, GraphFormat::kG2o), text);
}

TEST(ReadGraph, LetsAVertexAndAParameterShareAnId) {
  const std::string text =
      "PARAMS_SE2OFFSET 0 0.5 0 0\nVERTEX_SE2 0 0 0 0\nVERTEX_XY 1 2 0\n"
      "EDGE_SE2_POINTXY_OFFSET 0 1 0 1.5 0 1 0 1\n";
  const GraphDocument d = read(text);
  EXPECT_EQ(compute_chi2(d.graph), 0.0);
  EXPECT_EQ(write(d, GraphFormat::kG2o), text);
}

TEST(ReadGraph, WeighsAToroEdgeWithoutInformationByTheIdentity) {
  const GraphDocument d =
      read("VERTEX3 0 0 0 0 0 0 0\nVERTEX3 1 1 0 0 0.1 -0.2 0.3\nEDGE3 0 1 1.5 0 0 0.1 -0.2 0.3\n");
  EXPECT_EQ(d.format, GraphFormat::kToro);
  EXPECT_TRUE(d.graph.find_batch<BetweenSe3>()->factor(0).information.isIdentity());
  EXPECT_NEAR(compute_chi2(d.graph), 0.25, 1e-15);
}

TEST(ReadGraph, TakesTorosOrderOfInformation) {
  const GraphDocument d =
      read("VERTEX2 0 0 0 0\nVERTEX2 1 0 0 0\nEDGE2 0 1 0 0 0 11 12 22 33 13 23\n");
  Eigen::Matrix3d expected;
  expected << 11, 12, 13, 12, 22, 23, 13, 23, 33;
  EXPECT_EQ(d.graph.find_batch<BetweenSe2>()->factor(0).information, expected);
}

TEST(ReadGraph, TakesRollPitchYawAsRzRyRx) {
  const GraphDocument d =
      read("VERTEX3 0 0 0 0 0.3 0.2 0.1\nVERTEX3 1 0 0 0 0 0 0\nEDGE3 0 1 0 0 0 0 0 0\n");
  const Eigen::Matrix3d expected = (Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()))
                                       .toRotationMatrix();
  EXPECT_TRUE(d.graph.values().pose3[0].rotation().matrix().isApprox(expected, 1e-15));
}

TEST(ReadGraph, MergesEquivalentPosesAndWritesThemEqual) {
  const GraphDocument d = read(
      "VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0\nVERTEX2 2 9 9 9\n"
      "EDGE2 0 2 1 0 0 1 0 1 1 0 0\nEDGE2 1 2 0 0 0 1 0 1 1 0 0\nEQUIV 1 2\n");
  EXPECT_EQ(d.graph.variables().size(), 2u);
  EXPECT_EQ(d.graph.factor_count(), 1u);
  EXPECT_EQ(compute_chi2(d.graph), 0.0);
  EXPECT_THAT(d.warnings,
              ElementsAre("f:5:1: an edge joins two ids of one pose (EQUIV) and is dropped"));
  EXPECT_EQ(write(d, GraphFormat::kToro),
            "VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0\nVERTEX2 2 1 0 0\nEDGE2 0 1 1 0 0 1 0 1 1 0 0\nEQUIV "
            "1 2\n");
}

TEST(ReadGraph, TakesSquareRootInformationOfIsam) {
  const GraphDocument d = read(
      "ODOMETRY 0 1 1 0 0 2 1 0 3 0 4\nLANDMARK 1 5 1 1 10 0 10\nEDGE2 0 1 1 0 0 1 0 0 1 0 1\n");
  EXPECT_EQ(d.format, GraphFormat::kIsam);
  Eigen::Matrix3d expected;
  expected << 4, 2, 0, 2, 10, 0, 0, 0, 16;
  const auto* between = d.graph.find_batch<BetweenSe2>();
  EXPECT_EQ(between->factor(0).information, expected);
  EXPECT_EQ(between->kinds()[0], FactorKind::kOdometry);
  EXPECT_EQ(between->kinds()[1], FactorKind::kLoop);
  EXPECT_EQ(d.graph.find_batch<LandmarkXy>()->factor(0).information(0, 0), 100.0);
}

TEST(ReadGraph, AsksForTheFormatWhereEdgesDoNotTell) {
  const std::string text = "EDGE2 0 1 1 0 0 1 0 1 1 0 0\n";
  const auto undecided = read_graph_text(text, "f");
  ASSERT_FALSE(undecided);
  EXPECT_EQ(undecided.error().to_string(),
            "f:1:1: EDGE2 and EDGE3 alone do not tell TORO from iSAM; name the format (--format "
            "toro or --format isam)");
  EXPECT_EQ(read(text, {.format = GraphFormat::kIsam}).format, GraphFormat::kIsam);
  EXPECT_EQ(read(text, {.format = GraphFormat::kToro}).format, GraphFormat::kToro);
}

TEST(WriteGraph, RefusesWhatAFormatCannotHold) {
  const GraphDocument d =
      read("VERTEX_SE2 0 0 0 0\nVERTEX_XY 1 2 0\nEDGE_BEARING_SE2_XY 0 1 0 1\n");
  EXPECT_EQ(write_graph_text(d, GraphFormat::kToro).error().message,
            "toro format cannot hold factors of type bearing_xy; choose g2o");
  EXPECT_EQ(write_graph_text(d, GraphFormat::kIsam).error().message,
            "isam format cannot hold factors of type bearing_xy; choose g2o");
  EXPECT_EQ(write_graph_text(d, GraphFormat::kDlr).error().message,
            "the dlr format is read only; choose g2o");
  const GraphDocument points = read("VERTEX_SE2 0 0 0 0\nVERTEX_XY 1 2 0\n");
  EXPECT_EQ(write_graph_text(points, GraphFormat::kToro).error().message,
            "toro format cannot hold landmarks (vertex 1); choose g2o");
  EXPECT_EQ(write_graph_text(points, GraphFormat::kIsam).error().message,
            "isam format cannot hold vertex 0, which has no edge; choose g2o");
  const GraphDocument unknown = read("VERTEX_SE2 0 0 0 0\nVERTEX2 1 2 0 0\n");
  EXPECT_THAT(write_graph_text(unknown, GraphFormat::kToro).error().message,
              HasSubstr("'VERTEX2 1 2 0 0' would get a meaning in toro format"));
}

// One line of every kind; the second text must equal the third in each format that can hold it.
constexpr std::string_view kEveryTag = R"(
PARAMS_SE2OFFSET 0 0.1 -0.2 0.3
PARAMS_SE3OFFSET 1 0.1 0.2 0.3 0.1 0.2 0.3 0.9
VERTEX_SE2 0 0 0 0
VERTEX_SE2 1 1.1 0.1 3.2
VERTEX_XY 2 2 0.3
VERTEX_SE3:QUAT 10 0 0 0 0 0 0 1
VERTEX_SE3:QUAT 11 1 2 3 -0.1 0.2 -0.3 -0.9
VERTEX_TRACKXYZ 12 0.1 0.2 0.3
FIX 0 10
EDGE_SE2 0 1 1 0.3 0.1 10 1 2 20 3 30
EDGE_SE2_XY 0 2 1 0.5 10 1 20
EDGE_BEARING_SE2_XY 1 2 0.7 5
EDGE_SE2_OFFSET 0 1 0 0 1 0.3 0.1 10 1 2 20 3 30
EDGE_SE2_POINTXY_OFFSET 1 2 0 1 0.5 10 1 20
EDGE_PRIOR_SE2 0 0.1 0.2 0.3 10 1 2 20 3 30
EDGE_PRIOR_SE2_XY 1 1 2 10 1 20
EDGE_SE3:QUAT 10 11 1 2 3.5 0.1 0.2 0.3 0.9 10 1 0 0 0 1 20 0 0 2 0 30 0 0 1 40 1 2 50 3 60
EDGE_SE3_TRACKXYZ 10 12 1 0.4 0.5 0.6 10 1 2 20 3 30
EDGE_SE3_OFFSET 10 11 1 1 1 2 3 0 0 0 1 10 1 0 0 0 1 20 0 0 2 0 30 0 0 1 40 1 2 50 3 60
EDGE_SE3_PRIOR 11 1 1 2 3 0 0 0 1 10 1 0 0 0 1 20 0 0 2 0 30 0 0 1 40 1 2 50 3 60
EDGE_CAIRN_RANGE 0 2 1.9 4
EDGE_CAIRN_RANGE 10 12 0.4 4
EDGE_CAIRN_RANGE_BEARING 1 2 1 2 5 1 6
EDGE_CAIRN_RANGE_BEARING 11 12 1 2 0.5 5 1 0 6 0 7
EDGE_CAIRN_GNSS 0 0.1 0.2 1 2 3 0.5 4
EDGE_CAIRN_GNSS 10 0.1 0.2 0.3 1 2 3 5 1 0 6 0 7
EDGE_CAIRN_ALTITUDE 11 2.5 9
EDGE_CAIRN_YAW 1 3 2
EDGE_CAIRN_YAW 11 -3 2
EDGE_CAIRN_GRAVITY 11 0.1 0.1 -0.9 5 1 6
)";

TEST(RoundTrip, KeepsEveryTagAndChi2) {
  const GraphDocument first = read(kEveryTag);
  EXPECT_TRUE(first.warnings.empty());
  EXPECT_EQ(first.graph.factor_count(), 21u);
  const std::string text = write(first, GraphFormat::kG2o);
  const GraphDocument second = read(text);
  EXPECT_EQ(second.graph.factor_count(), 21u);
  EXPECT_NEAR(compute_chi2(second.graph), compute_chi2(first.graph),
              1e-12 * compute_chi2(first.graph));
  EXPECT_EQ(write(second, GraphFormat::kG2o), text);
}

TEST(RoundTrip, StandsStillInToroAndIsam) {
  std::string text =
      "ODOMETRY 0 1 1 0.3 0.1 3.1 1.7 2.3 7.7 3.3 11.1\nEDGE2 1 2 1 0.3 3.1 0.1 0.7 0.3 0.7 0.3 "
      "0.1\n";
  text +=
      "EDGE3 10 11 1 2 3 0.3 1.5707963 -2 10.1 1 0 0 0 1 20.3 0 0 2 0 30.7 0 0 1 40.9 1 2 50.1 3 "
      "60.3\n";
  const GraphDocument isam = read(text);
  const std::string isam_text = write(isam, GraphFormat::kIsam);
  EXPECT_EQ(write(read(isam_text), GraphFormat::kIsam), isam_text);
  const std::string toro_text = write(isam, GraphFormat::kToro);
  const GraphDocument toro = read(toro_text);
  EXPECT_EQ(toro.format, GraphFormat::kToro);
  EXPECT_EQ(write(toro, GraphFormat::kToro), toro_text);
  EXPECT_EQ(write(read(write(toro, GraphFormat::kG2o)), GraphFormat::kToro), toro_text);
}

// A pivot small beside its column is known to few digits: those must be the same at every writing.
TEST(RoundTrip, StandsStillWhereSquareRootInformationIsBadlyScaled) {
  const std::string text =
      write(read("ODOMETRY 0 1 1 0.3 0.1 3.1 0.7 2.3 0.0013 0.7 0.00217\n"
                 "ODOMETRY 1 2 1 0.3 0.1 0.7 0.7 0.3 0.0000311 0.9 0.00000013\n"
                 "LANDMARK 1 7 1 0.3 0.7 123.4 0.00123\n"),
            GraphFormat::kIsam);
  EXPECT_EQ(write(read(text), GraphFormat::kIsam), text);
}

TEST(WriteGraph, RefusesInformationThatItsSquareRootCannotHold) {
  const auto isam = [](const std::string& information) {
    return write_graph_text(
        read("VERTEX_SE2 4 0 0 0\nVERTEX_SE2 5 1 0 0\nEDGE_SE2 4 5 1 0 0 " + information + "\n"),
        GraphFormat::kIsam);
  };
  EXPECT_TRUE(isam("1 1 0 1 0 1"));  // singular, but its root is exact
  EXPECT_TRUE(isam("1 1 0 1.000001 0.0009 1"));
  EXPECT_EQ(isam("1 1 0 1.00000000000001 0.9e-7 1").error().message,
            "the information of the factor on vertices 4 and 5 is too near to singular for the "
            "square root that isam format holds; choose g2o");
}

TEST(WriteGraph, NamesSensorOffsetsThatHaveNoName) {
  GraphDocument d = read("VERTEX_SE2 0 0 0 0\nVERTEX_XY 1 2 0\nPARAMS_SE2OFFSET 0 1 0 0\n");
  LandmarkXy factor{.p_sensor_measured = {1.0, 0.0},
                    .sensor = {Se2(0.5, 0.0, 0.0), {}},
                    .information = Eigen::Matrix2d::Identity()};
  ASSERT_TRUE(d.graph.add_factor(factor, {VariableId{0}, VariableId{1}}));
  EXPECT_THAT(write(d, GraphFormat::kG2o), HasSubstr("PARAMS_SE2OFFSET 1 0.5 0 0\n"));
  EXPECT_THAT(write(d, GraphFormat::kG2o), HasSubstr("EDGE_SE2_POINTXY_OFFSET 0 1 1 1 0 1 0 1\n"));
}

}  // namespace
}  // namespace cairn
