// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>

#include "cairn/drawing/color_scale.hpp"
#include "cairn/drawing/projection.hpp"
#include "cairn/drawing/ruler.hpp"
#include "cairn/drawing/thinning.hpp"
#include "cairn/drawing/utf8.hpp"

namespace {

using namespace cairn::drawing;
using Eigen::Vector3d;
using testing::DoubleNear;
using testing::ElementsAre;

TEST(Ruler, RoundsToOneTwoFive) {
  EXPECT_DOUBLE_EQ(round_down_125(4.9), 2.0);
  EXPECT_DOUBLE_EQ(round_down_125(0.05), 0.05);
  EXPECT_DOUBLE_EQ(round_down_125(1000.0), 1000.0);
  EXPECT_DOUBLE_EQ(round_down_125(0.0), 0.0);
  EXPECT_DOUBLE_EQ(round_up_125(2.1), 5.0);
  EXPECT_DOUBLE_EQ(round_up_125(0.6), 1.0);
  EXPECT_DOUBLE_EQ(round_up_125(1.1), 2.0);
  EXPECT_DOUBLE_EQ(round_up_125(5.0), 5.0);
}

TEST(Ruler, TicksAreRoundAndCoverTheRange) {
  EXPECT_THAT(linear_ticks(0.0, 10.0, 5), ElementsAre(0.0, 2.0, 4.0, 6.0, 8.0, 10.0));
  EXPECT_EQ(format_number(linear_ticks(-1.0, 1.0, 4)[2], 4), "0");
  EXPECT_THAT(logarithmic_ticks(0.1, 100.0),
              ElementsAre(DoubleNear(0.1, 1e-12), DoubleNear(1, 1e-12), DoubleNear(10, 1e-12),
                          DoubleNear(100, 1e-9)));
}

TEST(Ruler, LengthsHaveTheirUsualUnit) {
  EXPECT_EQ(format_length(5000.0), "5 km");
  EXPECT_EQ(format_length(20.0), "20 m");
  EXPECT_EQ(format_length(0.5), "50 cm");
  EXPECT_EQ(format_length(0.002), "2 mm");
}

TEST(Color, LightnessOfTheRampFallsEvenly) {
  const auto luminance = [](const Color& c) {
    return 0.2126 * c.red + 0.7152 * c.green + 0.0722 * c.blue;
  };
  for (int bin = 1; bin < ColorScale::kBins; ++bin) {
    EXPECT_LT(luminance(ColorScale::bin_color(bin)), luminance(ColorScale::bin_color(bin - 1)))
        << bin;
  }
}

TEST(ColorScale, IsLogarithmicWhereFewValuesDwarfTheOthers) {
  EXPECT_FALSE(choose_color_scale({0.5, 1.0, 2.0, 3.0}).logarithmic);
  const ColorScale scale = choose_color_scale({1.0, 1.0, 1.0, 2.0, 500.0, 500.0});
  EXPECT_TRUE(scale.logarithmic);
  EXPECT_EQ(scale.bin(1e9), ColorScale::kBins - 1);
  EXPECT_EQ(scale.bin(0.0), 0);
}

TEST(ColorScale, TakesZerosAndNothing) {
  EXPECT_EQ(choose_color_scale({0.0, 0.0}).bin(0.0), 0);
  EXPECT_EQ(choose_color_scale({}).bin(0.5), ColorScale::kBins / 2);
}

TEST(Projection, ShowsAPlaneFaceOnWithItsAxesUpright) {
  std::vector<Vector3d> ground, camera;
  for (int i = 0; i < 20; ++i) {
    ground.emplace_back(i, i * i % 7, 0.0);
    camera.emplace_back(i, 1e-3 * (i % 3), i * i % 7);  // z forward, y down
  }
  EXPECT_TRUE(choose_projection(ground).R_view_map.isIdentity());
  const Projection view = choose_projection(camera);
  EXPECT_FALSE(view.has_depth);
  EXPECT_GT((view * Vector3d::UnitX()).x(), 0.99);
  EXPECT_GT((view * Vector3d::UnitZ()).y(), 0.99);
}

TEST(Projection, IsARotationThatKeepsUpUpward) {
  const std::vector<Vector3d> ball{{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                   {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
  const Projection view = choose_projection(ball);
  EXPECT_TRUE(view.has_depth);
  EXPECT_TRUE((view.R_view_map * view.R_view_map.transpose()).isIdentity(1e-12));
  EXPECT_NEAR(view.R_view_map.determinant(), 1.0, 1e-12);
  EXPECT_NEAR((view * Vector3d::UnitZ()).x(), 0.0, 1e-12);
  EXPECT_GT((view * Vector3d::UnitZ()).y(), 0.5);
}

TEST(Thinning, KeepsTheBudgetAndTheHighestLayer) {
  std::vector<Stroke> strokes;
  for (int i = 0; i < 10'000; ++i) {
    const Point p(i % 100, i / 100);
    strokes.push_back({{p, p + Point(1, 0)}, 0.0F, i == 4321 ? 7 : 0});
  }
  drop_covered(strokes, 0.4, 500);
  EXPECT_LE(strokes.size(), 500u);
  EXPECT_TRUE(
      std::any_of(strokes.begin(), strokes.end(), [](const Stroke& s) { return s.layer == 7; }));
}

TEST(Thinning, JoinsShortStepsAndKeepsTheEnd) {
  std::vector<Stroke> steps;
  for (int i = 0; i < 1000; ++i)
    steps.push_back({{Point(0.01 * i, 0), Point(0.01 * (i + 1), 0)}, 0.0F, 0});
  const std::vector<Stroke> joined = joined_steps(steps, 0.5);
  EXPECT_LT(joined.size(), 25u);
  EXPECT_DOUBLE_EQ(joined.back().line.b.x(), 10.0);
}

TEST(Utf8, ReplacesWhatIsNotText) {
  EXPECT_EQ(printable_utf8("caf\xC3\xA9"), "caf\xC3\xA9");
  EXPECT_EQ(printable_utf8("caf\xE9!"), "caf?!");
  EXPECT_EQ(printable_utf8("a\nb\xC0\x80"), "a?b??");
  EXPECT_EQ(shortened("abcdefghij", 5), "ab\u2026ij");
}

}  // namespace
