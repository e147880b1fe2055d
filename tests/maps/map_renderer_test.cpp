// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/maps/map_renderer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/maps/slow_map.hpp"

namespace cairn {
namespace {

using test::known_cells;
using test::SlowMap;

constexpr double kResolution = 0.1;

// Some scans with their poses, and the referee for them.
struct World {
  std::mt19937 random;
  std::vector<std::shared_ptr<const RangeScan>> scans;
  std::vector<PlacedScan> placed;

  explicit World(unsigned seed, std::size_t count) : random(seed) {
    while (scans.size() < count) add();
  }
  void add() {
    scans.push_back(std::make_shared<RangeScan>(test::random_scan(random)));
    placed.push_back({scans.size() - 1, test::random_pose(random, 20.0)});
  }
  [[nodiscard]] ScanSource source() const {
    return [this](ScanId id) { return scans[id]; };
  }
  [[nodiscard]] SlowMap at(const std::map<ScanId, Se2>& poses) const {
    SlowMap map;
    for (const auto& [id, pose] : poses) test::add_slowly(*scans[id], pose, kResolution, map);
    return map;
  }
};

TEST(MapRenderer, GivesWhatTheSlowRefereeGives) {
  const World world(1, 12);
  LaserMap map(kResolution);
  const RenderReport report = map.render(world.placed, world.source(), Precision::kExact);
  EXPECT_EQ(report.added, 12u);
  EXPECT_EQ(known_cells(map.grid()), world.at(map.rendered_poses()));
}

TEST(MapRenderer, StaysEqualToAFullRenderOverRandomMoves) {
  World world(2, 20);
  LaserMap map(kResolution);
  std::uniform_int_distribution<int> kind(0, 5);
  std::size_t kept = 0;
  for (int round = 0; round < 30; ++round) {
    for (PlacedScan& placed : world.placed) {
      const int move = kind(world.random);
      if (move == 0) placed.T_map_body = test::random_pose(world.random, 20.0);
      if (move == 1) placed.T_map_body = placed.T_map_body.retract({0.003, 0.002, 0.0003});
    }
    if (round % 4 == 1) world.add();
    if (round % 4 == 3) world.placed.erase(world.placed.begin() + round % 7);
    const auto precision = round % 5 == 4 ? Precision::kExact : Precision::kTolerant;
    kept += map.render(world.placed, world.source(), precision).kept;
    LaserMap afresh(kResolution);
    std::vector<PlacedScan> rendered;
    for (const auto& [id, pose] : map.rendered_poses()) rendered.push_back({id, pose});
    afresh.render(rendered, world.source(), Precision::kExact);
    ASSERT_EQ(map.grid(), afresh.grid()) << "round " << round;
    if (round % 10 == 0) {
      ASSERT_EQ(known_cells(map.grid()), world.at(map.rendered_poses())) << "round " << round;
    }
  }
  EXPECT_GT(kept, 200u);
}

TEST(MapRenderer, DoesNotDependOnTheOrderOfScans) {
  World world(3, 15);
  LaserMap forward(kResolution), backward(kResolution);
  forward.render(world.placed, world.source(), Precision::kExact);
  std::reverse(world.placed.begin(), world.placed.end());
  backward.render(world.placed, world.source(), Precision::kExact);
  EXPECT_EQ(forward.grid(), backward.grid());
}

TEST(MapRenderer, LeavesWhatHasHardlyMovedUnlessAskedToBeExact) {
  World world(4, 3);
  LaserMap map(kResolution);
  map.render(world.placed, world.source(), Precision::kTolerant);
  const Se2 before = world.placed[1].T_map_body;
  world.placed[1].T_map_body = Se2(before.x() + 0.009, before.y(), before.theta() + 0.0008);
  RenderReport report = map.render(world.placed, world.source(), Precision::kTolerant);
  EXPECT_EQ(report.kept, 3u);
  EXPECT_TRUE(report.changed.empty());
  report = map.render(world.placed, world.source(), Precision::kExact);
  EXPECT_EQ(report.added, 1u);
  EXPECT_EQ(known_cells(map.grid()), world.at({{0, world.placed[0].T_map_body},
                                               {1, world.placed[1].T_map_body},
                                               {2, world.placed[2].T_map_body}}));
}

TEST(MapRenderer, ChangesOnlyTilesOfTheOldAndTheNewPlace) {
  World world(5, 6);
  LaserMap map(kResolution);
  map.render(world.placed, world.source(), Precision::kExact);
  const Grid<HitMissCell> before = map.grid();
  world.placed[2].T_map_body = Se2(100.0, 100.0, 1.0);
  const RenderReport report = map.render(world.placed, world.source(), Precision::kExact);
  EXPECT_EQ(report.added, 1u);
  EXPECT_EQ(report.kept, 5u);
  std::size_t untouched = 0;
  for (const auto& [index, tile] : before) {
    if (report.changed.contains(index)) continue;
    ++untouched;
    EXPECT_EQ(map.grid().at(index), tile);
  }
  EXPECT_GT(untouched, 0u);
}

TEST(MapRenderer, TakesUpAScanThatComesLateAndSurvivesOneThatIsGone) {
  const World world(6, 4);
  LaserMap map(kResolution);
  ScanId absent = 2;
  const ScanSource source = [&](ScanId id) { return id == absent ? nullptr : world.scans[id]; };
  EXPECT_EQ(map.render(world.placed, source, Precision::kExact).missing, 1u);
  EXPECT_EQ(map.rendered_poses().size(), 3u);
  absent = 99;
  EXPECT_EQ(map.render(world.placed, source, Precision::kExact).added, 1u);
  EXPECT_EQ(known_cells(map.grid()), world.at(map.rendered_poses()));

  absent = 1;  // it was in the map, and now cannot be read any more
  const std::vector<PlacedScan> rest{world.placed[0], world.placed[2], world.placed[3]};
  EXPECT_EQ(map.render(rest, source, Precision::kExact).added, 3u);
  EXPECT_EQ(known_cells(map.grid()), world.at(map.rendered_poses()));
}

TEST(MapRenderer, GoesOnWhereItWasStopped) {
  const World world(7, 8);
  LaserMap map(kResolution);
  int calls = 0;
  EXPECT_FALSE(
      map.render(world.placed, world.source(), Precision::kExact, [&] { return ++calls <= 3; })
          .finished);
  EXPECT_EQ(map.rendered_poses().size(), 3u);
  EXPECT_EQ(known_cells(map.grid()), world.at(map.rendered_poses()));
  EXPECT_TRUE(map.render(world.placed, world.source(), Precision::kExact).finished);
  EXPECT_EQ(map.rendered_poses().size(), 8u);
}

TEST(MapRenderer, LeavesOutPosesThatAreNowhere) {
  World world(8, 4);
  world.placed[0].T_map_body = Se2(1e12, 0.0, 0.0);
  world.placed[1].T_map_body = Se2(std::nan(""), 0.0, 0.0);
  world.placed[2].T_map_body = Se2(-1e300, 1e300, 0.0);
  LaserMap map(kResolution);
  map.render(world.placed, world.source(), Precision::kTolerant);
  EXPECT_EQ(known_cells(map.grid()), world.at({{3, world.placed[3].T_map_body}}));
}

TEST(SonarMap, TakesAwayWhatItHasAdded) {
  World world(9, 6);
  SonarMap map(kResolution), afresh(kResolution);
  map.render(world.placed, world.source(), Precision::kExact);
  EXPECT_FALSE(map.grid().empty());
  world.placed[3].T_map_body = Se2(1.0, 2.0, 0.5);
  map.render(world.placed, world.source(), Precision::kExact);
  afresh.render(world.placed, world.source(), Precision::kExact);
  EXPECT_EQ(map.grid(), afresh.grid());
}

}  // namespace
}  // namespace cairn
