// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/evaluation/trajectory_error.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "cairn/evaluation/alignment.hpp"
#include "cairn/evaluation/association.hpp"
#include "cairn/evaluation/statistics.hpp"
#include "tests/support/datasets.hpp"

namespace cairn {
namespace {

std::vector<Se3> along_x(const std::vector<double>& x_m) {
  std::vector<Se3> poses;
  for (const double x : x_m) poses.emplace_back(So3(), Eigen::Vector3d(x, 0.0, 0.0));
  return poses;
}

Trajectory read_file(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  auto trajectory = read_trajectory_text(text.str(), path);
  EXPECT_TRUE(trajectory);
  return *trajectory;
}

Association kitti_orb(const std::string& reference, const std::string& estimate) {
  auto matches = associate(read_file(reference), read_file(estimate));
  EXPECT_TRUE(matches);
  return std::move(*matches);
}

TEST(AbsoluteErrors, MeasureTranslationAndRotationPoseByPose) {
  const std::vector<Se3> reference{Se3(So3::exp({0.0, 0.0, 1.0}), {1.0, 0.0, 0.0})};
  const std::vector<Se3> estimate{Se3(So3::exp({0.0, 0.0, 1.5}), {1.0, 3.0, 4.0})};
  const PoseErrors errors = absolute_errors(reference, estimate);
  EXPECT_NEAR(errors.translation_m[0], 5.0, 1e-14);
  EXPECT_NEAR(errors.rotation_deg[0], 28.64788975654116, 1e-12);
}

TEST(RelativeErrors, IgnoreWhereATrajectoryStartsAndSeeADriftingScale) {
  const Se3 T_moved(So3::exp({0.3, -0.5, 2.0}), {7.0, 8.0, 9.0});
  const auto reference = along_x({0.0, 1.0, 2.0, 3.0});
  auto estimate = along_x({0.0, 1.5, 3.0, 4.5});
  for (Se3& T : estimate) T = T_moved * T;
  const PoseErrors errors = relative_errors(reference, estimate, choose_pairs(estimate, {}));
  ASSERT_EQ(errors.translation_m.size(), 3u);
  for (const double error : errors.translation_m) EXPECT_NEAR(error, 0.5, 1e-13);
  for (const double error : errors.rotation_deg) EXPECT_NEAR(error, 0.0, 1e-6);
  EXPECT_EQ(errors.at, (std::vector<std::size_t>{1, 2, 3}));
}

using Pairs = std::vector<PosePair>;

TEST(ChoosePairs, ByPosesConsecutiveOrAll) {
  const auto poses = along_x({0, 1, 2, 3, 4, 5, 6});
  EXPECT_EQ(choose_pairs(poses, {.delta = 3}), (Pairs{{0, 3}, {3, 6}}));
  EXPECT_EQ(choose_pairs(poses, {.delta = 5, .consecutive = false}), (Pairs{{0, 5}, {1, 6}}));
  EXPECT_EQ(choose_pairs(poses, {.delta = 7}), Pairs{});
}

TEST(ChoosePairs, ByMetresConsecutivelyMarksNeverPoseZero) {
  // Path since the last mark: 1, 2.5 (mark 2), 1, 2 (mark 4), 1, 3 (mark 6).
  const auto poses = along_x({0, 1, 2.5, 3.5, 4.5, 5.5, 7.5, 8});
  EXPECT_EQ(choose_pairs(poses, {.delta = 2, .in_metres = true}), (Pairs{{2, 4}, {4, 6}}));
}

TEST(ChoosePairs, ByMetresAllPairsBeginAtEveryPose) {
  const auto poses = along_x({0, 1, 2.5, 3.5, 4.5});
  EXPECT_EQ(choose_pairs(poses, {.delta = 2, .in_metres = true, .consecutive = false}),
            (Pairs{{0, 2}, {1, 3}, {2, 4}}));
}

TEST(KittiOrb, AbsoluteErrorAfterRigidAlignmentIsThePublishedOne) {
  CAIRN_REQUIRE_DATASET(reference, "trajectories/KITTI_00_gt.txt");
  CAIRN_REQUIRE_DATASET(estimate, "trajectories/KITTI_00_ORB.txt");
  Association matches = kitti_orb(reference, estimate);
  const Alignment alignment = align(AlignmentKind::kSe3, matches.reference, matches.estimate);
  for (Se3& T : matches.estimate) T = alignment * T;
  const Statistics s =
      compute_statistics(absolute_errors(matches.reference, matches.estimate).translation_m);
  // All seven of the other tool's numbers, from KITTI_00_orb_ape.stats.json.
  EXPECT_NEAR(s.rmse, 1.3034497145650266, 1e-6);
  EXPECT_NEAR(s.mean, 1.1569971285389768, 1e-6);
  EXPECT_NEAR(s.standard_deviation, 0.6002822693968323, 1e-6);
  EXPECT_NEAR(s.median, 1.065624769555848, 1e-6);
  EXPECT_NEAR(s.min, 0.06931322021483087, 1e-6);
  EXPECT_NEAR(s.max, 3.587949120678954, 1e-6);
}

TEST(KittiOrb, RelativeErrorOverTenMetresIsThePublishedOne) {
  CAIRN_REQUIRE_DATASET(reference, "trajectories/KITTI_00_gt.txt");
  CAIRN_REQUIRE_DATASET(estimate, "trajectories/KITTI_00_ORB.txt");
  const Association matches = kitti_orb(reference, estimate);
  const auto pairs = choose_pairs(matches.estimate, {.delta = 10.0, .in_metres = true});
  EXPECT_EQ(pairs.size(), 353u);
  const Statistics s =
      compute_statistics(relative_errors(matches.reference, matches.estimate, pairs).translation_m);
  EXPECT_NEAR(s.rmse, 0.22626134329310163, 1e-6);
  EXPECT_NEAR(s.mean, 0.16901737200653275, 1e-6);
  EXPECT_NEAR(s.standard_deviation, 0.1504238127053164, 1e-6);
  EXPECT_NEAR(s.median, 0.13848432516645606, 1e-6);
  EXPECT_NEAR(s.min, 0.025322719660754993, 1e-6);
  EXPECT_NEAR(s.max, 1.2722090778658726, 1e-6);
}

}  // namespace
}  // namespace cairn
