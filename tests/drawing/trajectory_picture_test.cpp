// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/drawing/trajectory_picture.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/picture_files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using namespace cairn;

TrajectoryErrors figure_eight(std::size_t poses) {
  TrajectoryErrors errors;
  for (std::size_t i = 0; i < poses; ++i) {
    const double t = 6.28 * static_cast<double>(i) / static_cast<double>(poses);
    const Eigen::Vector3d p(100 * std::sin(t), 60 * std::sin(2 * t), 0);
    const double error = 1.0 + std::sin(7 * t);
    errors.reference.push_back(p);
    errors.estimate.push_back(p + Eigen::Vector3d(0, error, 0));
    errors.index.push_back(i);
    errors.path_m.push_back(static_cast<double>(i));
    errors.error.push_back(error);
  }
  return errors;
}

TEST(TrajectoryPicture, DrawsOnePoseAndManyAsPngAndSvg) {
  const test::TemporaryFolder folder;
  for (const std::size_t poses : {1u, 2u, 1000u, 100'000u}) {
    ASSERT_TRUE(draw_trajectory_errors(figure_eight(poses), folder.file("a.png")));
    EXPECT_TRUE(test::png_size(test::read_file(folder.file("a.png")))) << poses;
    ASSERT_TRUE(draw_trajectory_errors(figure_eight(poses), folder.file("a.svg")));
    const std::string svg = test::read_file(folder.file("a.svg"));
    EXPECT_TRUE(test::is_well_formed_svg(svg)) << poses;
    EXPECT_LT(svg.size(), 8'000'000u) << poses;
  }
}

TEST(TrajectoryPicture, RefusesWhatItCannotDraw) {
  const test::TemporaryFolder folder;
  TrajectoryErrors unequal = figure_eight(5), infinite = figure_eight(5), outside = figure_eight(5);
  unequal.path_m.pop_back();
  infinite.error[2] = HUGE_VAL;
  outside.index[4] = 5;
  for (const TrajectoryErrors& errors : {TrajectoryErrors{}, unequal, infinite, outside}) {
    const auto drawn = draw_trajectory_errors(errors, folder.file("a.png"));
    ASSERT_FALSE(drawn);
    EXPECT_EQ(drawn.error().code, ErrorCode::kBadInput);
  }
  EXPECT_EQ(folder.file_count(), 0u);
}

}  // namespace
