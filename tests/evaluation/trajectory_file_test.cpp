// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "cairn/evaluation/alignment.hpp"
#include "cairn/evaluation/association.hpp"
#include "cairn/evaluation/statistics.hpp"
#include "cairn/evaluation/trajectory_error.hpp"
#include "tests/support/datasets.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

TEST(TrajectoryFile, TakesThePosesOfAGraphInOrderOfTheirIds) {
  const test::TemporaryFolder folder;
  const auto trajectory =
      read_trajectory(folder.write("graph",
                                   "VERTEX_SE2 7 1 2 0.5\nVERTEX_XY 9 5 5\nVERTEX_SE2 "
                                   "3 0 0 0\nEDGE_SE2 3 7 1 2 0.5 1 0 0 1 0 1\n"));
  ASSERT_TRUE(trajectory) << trajectory.error().to_string();
  EXPECT_EQ(trajectory->format, TrajectoryFormat::kGraph);
  EXPECT_TRUE(trajectory->planar);
  ASSERT_EQ(trajectory->poses.size(), 2u);
  EXPECT_EQ(trajectory->poses[0].key, 3u);
  EXPECT_EQ(trajectory->poses[1].key, 7u);
  EXPECT_EQ(trajectory->poses[1].T_world_body.translation(), Eigen::Vector3d(1.0, 2.0, 0.0));
  EXPECT_NEAR(trajectory->poses[1].T_world_body.rotation().log().z(), 0.5, 1e-15);
  EXPECT_TRUE(trajectory->warnings.empty());
}

TEST(TrajectoryFile, SaysWhenAGraphHasEdgesOnly) {
  const test::TemporaryFolder folder;
  const auto trajectory =
      read_trajectory(folder.write("graph", "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n"));
  ASSERT_TRUE(trajectory) << trajectory.error().to_string();
  ASSERT_EQ(trajectory->warnings.size(), 1u);
  EXPECT_NE(trajectory->warnings[0].find("chains of edges"), std::string::npos);
}

TEST(TrajectoryFile, PassesOnWhatTheGraphReaderSays) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(read_trajectory(folder.file("absent")).error().code, ErrorCode::kBadInput);
  const auto bad = read_trajectory(folder.write("bad.g2o", "VERTEX_SE2 0 0 0\n"));
  ASSERT_FALSE(bad);
  EXPECT_NE(bad.error().place.find("bad.g2o:1:1"), std::string::npos) << bad.error().to_string();
}

TEST(TrajectoryFile, ComparesAGraphWithItsTruth) {
  CAIRN_REQUIRE_DATASET(truth_path, "graphs/truth/sphere_gt.g2o");
  CAIRN_REQUIRE_DATASET(graph_path, "graphs/truth/sphere.g2o");
  const auto truth = read_trajectory(truth_path), estimate = read_trajectory(graph_path);
  ASSERT_TRUE(truth && estimate);
  const auto matches = associate(*truth, *estimate);
  ASSERT_TRUE(matches);
  EXPECT_EQ(matches->reference.size(), 2500u);
  EXPECT_EQ(matches->unmatched, 0u);
  // The file's start drifts by tens of metres around a sphere of 100 m.
  const Statistics drift =
      compute_statistics(absolute_errors(matches->reference, matches->estimate).translation_m);
  EXPECT_GT(drift.rmse, 10.0);
  EXPECT_EQ(drift.min, 0.0);
}

TEST(TrajectoryFile, MatchesMotionCaptureByTime) {
  CAIRN_REQUIRE_DATASET(truth_path, "trajectories/freiburg1_xyz-groundtruth.txt");
  CAIRN_REQUIRE_DATASET(estimate_path, "trajectories/freiburg1_xyz-rgbdslam.txt");
  const auto truth = read_trajectory(truth_path), estimate = read_trajectory(estimate_path);
  ASSERT_TRUE(truth && estimate);
  const auto matches = associate(*truth, *estimate);
  ASSERT_TRUE(matches);
  EXPECT_GT(matches->reference.size(), 780u);
  const Alignment alignment = align(AlignmentKind::kSe3, matches->reference, matches->estimate);
  std::vector<Se3> aligned = matches->estimate;
  for (Se3& T : aligned) T = alignment * T;
  // About a centimetre, as this log is known for; the last digits depend on the rule of
  // association.
  EXPECT_NEAR(compute_statistics(absolute_errors(matches->reference, aligned).translation_m).rmse,
              0.0135, 0.001);
}

}  // namespace
}  // namespace cairn
