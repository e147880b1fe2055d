// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "cairn/io/trajectory.hpp"

namespace cairn {
namespace {

std::string error_of(std::string_view text) {
  const auto trajectory = read_trajectory_text(text, "log.txt");
  return trajectory ? "read without error" : trajectory.error().to_string();
}

TEST(TumText, ReadsStampsToTheNanosecondAndPosesAsGiven) {
  const auto trajectory = read_trajectory_text(
      "# comment\n\n1305031102.160407123 1.5 -2 3e0 0 0 0.6 0.8\r\n1.305031102175304890e+09 0 0 0 "
      "0 0 0 -1\n",
      "log.txt");
  ASSERT_TRUE(trajectory);
  EXPECT_EQ(trajectory->format, TrajectoryFormat::kTum);
  ASSERT_EQ(trajectory->poses.size(), 2u);
  EXPECT_EQ(trajectory->poses[0].key, 1305031102160407123u);
  EXPECT_EQ(trajectory->poses[0].T_world_body.translation(), Eigen::Vector3d(1.5, -2.0, 3.0));
  EXPECT_EQ(trajectory->poses[0].T_world_body.rotation().quaternion().coeffs(),
            Eigen::Vector4d(0.0, 0.0, 0.6, 0.8));
  EXPECT_NEAR(static_cast<double>(trajectory->poses[1].key - 1305031102000000000u), 175304890.0,
              200.0);
}

TEST(KittiText, ReadsARowMajorMatrixAndNumbersItsLines) {
  const auto trajectory =
      read_trajectory_text("1 0 0 5 0 1 0 6 0 0 1 7\n0 -1 0 1 1 0 0 2 0 0 1 3", "log.txt");
  ASSERT_TRUE(trajectory);
  EXPECT_EQ(trajectory->format, TrajectoryFormat::kKitti);
  ASSERT_EQ(trajectory->poses.size(), 2u);
  EXPECT_EQ(trajectory->poses[1].key, 1u);
  EXPECT_EQ(trajectory->poses[0].T_world_body.translation(), Eigen::Vector3d(5.0, 6.0, 7.0));
  const Eigen::Vector3d turned = trajectory->poses[1].T_world_body * Eigen::Vector3d(1.0, 0.0, 0.0);
  EXPECT_LT((turned - Eigen::Vector3d(1.0, 3.0, 3.0)).norm(), 1e-15);
}

TEST(TrajectoryText, NamesLineAndColumnOfWhatIsWrong) {
  EXPECT_EQ(error_of("1 0 0 0 0 0 0 1\n2 0 0 0 0 0 1\n"),
            "log.txt:2:1: a TUM line has 8 numbers (stamp tx ty tz qx qy qz qw), found 7");
  EXPECT_EQ(error_of("1 0 0 0 0 0 0 1\n2 0 0 x 0 0 0 1\n"), "log.txt:2:7: 'x' is not a number");
  EXPECT_EQ(error_of("1 0 0 nan 0 0 0 1\n"), "log.txt:1:7: 'nan' is not a finite number");
  EXPECT_EQ(error_of("1 0 0 1,5 0 0 0 1\n"), "log.txt:1:7: '1,5' has a decimal comma; write 1.5");
  EXPECT_EQ(
      error_of("1 0 0 0 0 0 0 0.5\n"),
      "log.txt:1:9: the quaternion has norm 0.500000; a unit quaternion qx qy qz qw is expected");
  EXPECT_EQ(error_of("-1 0 0 0 0 0 0 1\n"),
            "log.txt:1:1: '-1' is not a time stamp: seconds from 0 to 9e9 are expected");
  EXPECT_EQ(error_of("  1 0 0 5 0 2 0 6 0 0 1 7\n"),
            "log.txt:1:3: columns 1-3, 5-7 and 9-11 are not a rotation matrix (orthonormal, "
            "determinant 1)");
  EXPECT_EQ(error_of("1 0 0 5 0 1 0 6 0 0 1 7\n1 0 0 5 0 1 0 6 0 0 1\n"),
            "log.txt:2:1: a KITTI line has 12 numbers (the upper 3 x 4 of the pose, row by row), "
            "found 11");
  EXPECT_EQ(error_of("1 2 3\n"),
            "log.txt:1:1: not a trajectory: the first line has 3 fields; 8 numbers (TUM) or 12 "
            "numbers (KITTI) are "
            "expected");
  EXPECT_EQ(error_of("# nothing\n"), "log.txt:1:1: holds no poses");
  EXPECT_EQ(error_of(""), "log.txt:1:1: holds no poses");
}

TEST(TrajectoryText, IsToldFromAGraphByItsFirstField) {
  EXPECT_EQ(recognize_trajectory("1 0 0 0 0 0 0 1"), TrajectoryFormat::kTum);
  EXPECT_EQ(recognize_trajectory("# stamp\n1 0 0 5 0 1 0 6 0 0 1 7"), TrajectoryFormat::kKitti);
  EXPECT_EQ(recognize_trajectory("EDGE_SE2 0 1 0 0 0 1 0"), std::nullopt);
  EXPECT_EQ(recognize_trajectory("VERTEX_SE2 0 0 0 0"), std::nullopt);
}

}  // namespace
}  // namespace cairn
