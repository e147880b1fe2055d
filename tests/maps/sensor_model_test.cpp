// SPDX-License-Identifier: BSD-3-Clause
// What one scan says of the cells around it.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "cairn/maps/map_image.hpp"
#include "cairn/maps/map_renderer.hpp"

namespace cairn {
namespace {

Grid<HitMissCell> render(const RangeScan& scan, const Se2& T_map_body, LaserLimits limits = {}) {
  LaserMap map(1.0, LaserCells(limits));
  map.render(
      std::vector<PlacedScan>{{0, T_map_body}},
      [&](ScanId) { return std::make_shared<RangeScan>(scan); }, Precision::kExact);
  return map.grid();
}

// The upper row first: # hit, . passed, blank nothing; x and y from 0.
std::string picture(const Grid<HitMissCell>& grid, int width, int height) {
  std::string text;
  for (int y = height - 1; y >= 0; --y) {
    for (int x = 0; x < width; ++x) {
      const HitMissCell cell = grid.contains({0, 0}) ? grid.at({0, 0}).at(x, y) : HitMissCell();
      EXPECT_LE(cell.hits + cell.misses, 1u) << "one update per cell and scan";
      text += cell.hits > 0 ? '#' : cell.misses > 0 ? '.' : ' ';
    }
    text += '\n';
  }
  return text;
}

RangeScan beams(std::vector<float> ranges, double step_rad = 0.5 * std::numbers::pi) {
  return {.first_angle_rad = 0.0,
          .angle_step_rad = step_rad,
          .max_range_m = 20.0,
          .T_body_laser = Se2(),
          .ranges_m = std::move(ranges)};
}

TEST(Laser, FreesTheWayToItsEcho) {
  EXPECT_EQ(picture(render(beams({4.0F, 2.0F}), Se2(0.5, 0.5, 0.0)), 6, 4),
            "      \n"
            "#     \n"
            ".     \n"
            "....# \n");
}

TEST(Laser, AnEchoOutweighsTheBeamsThatPass) {
  EXPECT_EQ(picture(render(beams({5.0F, 3.0F}, 0.0), Se2(0.5, 0.5, 0.0)), 6, 1), "...#.#\n");
}

TEST(Laser, SeesNothingWhereThereIsNoEchoUnlessTold) {
  const RangeScan scan = beams({20.0F, std::numeric_limits<float>::quiet_NaN()});
  EXPECT_TRUE(render(scan, Se2(0.5, 0.5, 0.0)).empty());
  EXPECT_EQ(picture(render(scan, Se2(0.5, 0.5, 0.0), {.no_echo_free_m = 3.0}), 6, 2),
            "      \n"
            "....  \n");
}

TEST(Laser, BelievesNoEchoFromTooFarAwayButTheWayThere) {
  EXPECT_EQ(picture(render(beams({5.0F}), Se2(0.5, 0.5, 0.0), {.farthest_m = 3.0}), 6, 1),
            "....  \n");
}

TEST(Laser, SitsWhereItIsMounted) {
  RangeScan scan = beams({2.0F});
  scan.T_body_laser = Se2(1.0, 2.0, 0.5 * std::numbers::pi);
  EXPECT_EQ(picture(render(scan, Se2(0.5, 0.5, 0.0)), 3, 6),
            "   \n"
            " # \n"
            " . \n"
            " . \n"
            "   \n"
            "   \n");
}

TEST(Sonar, IsLinearInRangeAndGaussianInAngle) {
  const SonarModel model;
  const SonarCells sonar(model);
  const auto at = [&](double distance, double angle) {
    return static_cast<double>(sonar.evidence_at(3.0, distance, angle));
  };
  EXPECT_NEAR(at(1.0, 0.0), model.miss * 0.8, 1.0);
  EXPECT_NEAR(at(2.0, 0.0), model.miss * 0.6, 1.0);
  EXPECT_NEAR(at(3.0, 0.0), model.hit * 0.4, 1.0);
  EXPECT_NEAR(at(1.0, 0.2) / at(1.0, 0.0), std::exp(-0.5 * std::pow(0.2 / 0.13, 2)), 0.01);
  EXPECT_EQ(at(1.0, 0.3), 0.0);
  EXPECT_EQ(at(3.2, 0.0), 0.0);
}

TEST(Sonar, LetsTheEchoOfOneBeamStandAgainstTheFreeConeOfAnother) {
  RangeScan scan = beams({2.0F, 4.0F}, 0.0);
  SonarCells sonar;
  sonar.trace(scan, Se2(), 0.05);
  double shell = 0.0, before = 0.0;
  sonar.for_each_tile([&](const TileIndex& tile, const SonarEvidence& evidence) {
    if (tile != TileIndex{0, 0}) return;
    shell = evidence.log_odds[40];   // x = 2.025 m
    before = evidence.log_odds[20];  // x = 1.025 m
  });
  EXPECT_GT(shell, 0.0);
  EXPECT_LT(before, 0.0);
}

TEST(MapImage, ReadsCellsByEitherModel) {
  const auto occupancy = [](std::uint32_t hits, std::uint32_t misses) {
    return state_of(HitMissCell{hits, misses}, MapModel::kOccupancy);
  };
  const auto reflection = [](std::uint32_t hits, std::uint32_t misses) {
    return state_of(HitMissCell{hits, misses}, MapModel::kReflection);
  };
  EXPECT_EQ(occupancy(0, 0), CellState::kUnknown);
  EXPECT_EQ(occupancy(1, 0), CellState::kOccupied);
  EXPECT_EQ(occupancy(0, 1), CellState::kFree);
  EXPECT_EQ(occupancy(1, 1), CellState::kUnknown);
  EXPECT_EQ(occupancy(4'000'000'000u, 1), CellState::kOccupied);
  EXPECT_EQ(reflection(0, 0), CellState::kUnknown);
  EXPECT_EQ(reflection(1, 2), CellState::kOccupied);
  EXPECT_EQ(reflection(3, 7), CellState::kUnknown);
  EXPECT_EQ(reflection(1, 3), CellState::kFree);
  EXPECT_NEAR(probability(HitMissCell{1, 0}, MapModel::kOccupancy), 0.7, 1e-3);
  EXPECT_NEAR(probability(HitMissCell{0, 1}, MapModel::kOccupancy), 0.4, 1e-3);
  EXPECT_EQ(probability(HitMissCell{1, 3}, MapModel::kReflection), 0.25);
}

TEST(MapImage, IsAsSmallAsTheMap) {
  const auto grid = render(beams({4.0F, 2.0F}), Se2(-1.5, 0.5, 0.0));
  const Result<MapImage> image = draw_map(grid, 1.0, MapModel::kOccupancy);
  ASSERT_TRUE(image.ok()) << image.error().to_string();
  EXPECT_EQ(image->width, 5u);
  EXPECT_EQ(image->height, 3u);
  EXPECT_EQ(image->T_map_image.to_vector(), Eigen::Vector3d(-2.0, 0.0, 0.0));
  EXPECT_EQ(image->at(0, 2), CellState::kOccupied);
  EXPECT_EQ(image->at(4, 0), CellState::kOccupied);
  EXPECT_EQ(image->at(1, 0), CellState::kFree);
  EXPECT_EQ(image->at(4, 2), CellState::kUnknown);
}

TEST(MapImage, OfNothingIsAnError) {
  EXPECT_EQ(draw_map({}, 0.05, MapModel::kOccupancy).error().code, ErrorCode::kNotUsable);
}

}  // namespace
}  // namespace cairn
