// SPDX-License-Identifier: BSD-3-Clause
// The daemon's tiles and a client's copy of them, without threads between them.
#include "server/published_tiles.hpp"

#include <gtest/gtest.h>

#include <random>

#include "clients/client/map_copy.hpp"

namespace cairn {
namespace {

constexpr std::uint32_t kBudget = 64u << 10;

MapTile noise(unsigned seed) {
  std::mt19937 random(seed);
  MapTile tile;
  for (TileCell& cell : tile) cell = static_cast<TileCell>(random() % 4);
  return tile;
}

// Everything that changed to the copy.
void tell(PublishedTiles& tiles, MapCopy& copy) {
  for (const TileBlock& block : tiles.take_changed_blocks({})) (void)copy.take(block);
}

// Asks until nothing is missing; gives the tiles in the order in which they came.
std::vector<TileIndex> fetch(const PublishedTiles& tiles, MapCopy& copy,
                             std::uint32_t budget = kBudget, double x_m = 0.0) {
  std::vector<TileIndex> came;
  while (const auto request = copy.next_request(x_m, 0.0, budget)) {
    const TileAnswer answer = tiles.answer(*request);
    std::size_t bytes = 0;
    for (const SentTile& sent : answer.tiles) {
      came.push_back(sent.tile);
      bytes += sent.cells.size();
    }
    EXPECT_LE(bytes, budget);
    EXPECT_TRUE(copy.take(answer));
    if (answer.tiles.empty()) {
      ADD_FAILURE() << "something is missing and does not come: " << answer.reason;
      break;
    }
  }
  return came;
}

PublishedTiles row_of(std::int64_t run, int count) {
  PublishedTiles tiles(run, 0.1);
  tiles.begin_revision();
  for (int x = 0; x < count; ++x) {
    const MapTile tile = noise(static_cast<unsigned>(x));
    tiles.put("m", {x - count / 2, 0}, &tile);
  }
  return tiles;
}

TEST(PublishedTiles, SendsTheNearestFirstWithinTheBudget) {
  PublishedTiles tiles = row_of(1, 40);
  MapCopy copy;
  tell(tiles, copy);
  const double x_m = 0.1 * 64 * 7.5;
  const auto came = fetch(tiles, copy, limits::kLeastTileBudget, x_m);
  ASSERT_EQ(came.size(), 40u);
  EXPECT_EQ(came.front(), (TileIndex{7, 0}));
  for (std::size_t i = 1; i < came.size(); ++i)
    EXPECT_GE(std::abs(came[i].x - 7), std::abs(came[i - 1].x - 7));
  EXPECT_EQ(copy.views().at(0).tiles.at({3, 0}), noise(23));
}

TEST(PublishedTiles, RaisesARevisionOnlyWithTheContent) {
  PublishedTiles tiles = row_of(1, 3);
  MapCopy copy;
  tell(tiles, copy);
  EXPECT_EQ(fetch(tiles, copy).size(), 3u);
  tiles.begin_revision();
  const MapTile same = noise(0), other = noise(9);
  EXPECT_FALSE(tiles.put("m", {-1, 0}, &same));
  EXPECT_TRUE(tiles.put("m", {1, 0}, &other));
  const auto blocks = tiles.take_changed_blocks({});
  ASSERT_EQ(blocks.size(), 1u);
  (void)copy.take(blocks[0]);
  EXPECT_EQ(fetch(tiles, copy), (std::vector<TileIndex>{{1, 0}}));
  EXPECT_TRUE(tiles.take_changed_blocks({}).empty());
}

// Half of what is new has come when more is new: known tiles are named one by one.
TEST(PublishedTiles, GoesOnWhereTheClientStoppedWhenMoreIsNew) {
  PublishedTiles tiles = row_of(1, 60);
  MapCopy copy;
  tell(tiles, copy);
  const auto request = copy.next_request(0.0, 0.0, limits::kLeastTileBudget);
  const TileAnswer first = tiles.answer(*request);
  ASSERT_TRUE(copy.take(first));
  ASSERT_LT(first.tiles.size(), 30u);
  tiles.begin_revision();
  const MapTile changed = noise(77);
  tiles.put("m", first.tiles[0].tile, &changed);
  tell(tiles, copy);
  EXPECT_EQ(fetch(tiles, copy).size(), 60 - first.tiles.size() + 1);
  EXPECT_EQ(copy.views().at(0).tiles.at(first.tiles[0].tile), changed);
}

TEST(PublishedTiles, TellsWhatIsGone) {
  PublishedTiles tiles = row_of(1, 20);
  MapCopy copy;
  tell(tiles, copy);
  fetch(tiles, copy);
  tiles.begin_revision();
  EXPECT_TRUE(tiles.put("m", {-3, 0}, nullptr));
  EXPECT_FALSE(tiles.put("m", {500, 0}, nullptr));
  EXPECT_EQ(tiles.tiles(), 19u);
  const auto blocks = tiles.take_changed_blocks({});
  ASSERT_EQ(blocks.size(), 1u);
  EXPECT_EQ(copy.take(blocks[0]).gone, (std::vector<TileIndex>{{-3, 0}}));
  EXPECT_FALSE(copy.next_request(0.0, 0.0, kBudget));
  EXPECT_EQ(copy.views().at(0).tiles.size(), 19u);
}

TEST(MapCopy, KnowsTilesOfAnotherRunByTheirContent) {
  PublishedTiles before = row_of(5, 30);
  MapCopy copy;
  tell(before, copy);
  fetch(before, copy);
  PublishedTiles after = row_of(6, 30);
  after.begin_revision();
  const MapTile changed = noise(99);
  after.put("m", {2, 0}, &changed);
  tell(after, copy);
  EXPECT_EQ(fetch(after, copy), (std::vector<TileIndex>{{2, 0}}));
  EXPECT_TRUE(copy.prune().empty());
}

TEST(MapCopy, PrunesWhatTheNextRunDoesNotName) {
  PublishedTiles before = row_of(5, 30), after = row_of(6, 10);
  MapCopy copy;
  tell(before, copy);
  fetch(before, copy);
  tell(after, copy);
  fetch(after, copy);
  const auto pruned = copy.prune();
  ASSERT_EQ(pruned.size(), 1u);
  EXPECT_EQ(pruned[0].gone.size(), 20u);
  EXPECT_EQ(copy.views().at(0).tiles.size(), 10u);
}

// The daemon's clock was set back: its run looks older than the one before.
TEST(MapCopy, BelievesTheRunThatAnswers) {
  PublishedTiles before = row_of(9, 10), after = row_of(4, 20);
  MapCopy copy;
  tell(before, copy);
  fetch(before, copy);
  const MapTile lost = noise(50);
  before.begin_revision();
  before.put("m", {0, 5}, &lost);
  tell(before, copy);  // the index; its daemon ends before it can answer
  tell(after, copy);
  const auto request = copy.next_request(0.0, 0.0, kBudget);
  ASSERT_TRUE(request);
  const TileAnswer refused = after.answer(*request);
  EXPECT_EQ(refused.error, ErrorCode::kNotUsable);
  EXPECT_TRUE(refused.tiles.empty());
  ASSERT_TRUE(copy.take(refused));
  EXPECT_EQ(fetch(after, copy).size(), 20u);
}

TEST(MapCopy, BeginsAnewWithAnotherResolution) {
  PublishedTiles before = row_of(5, 6);
  MapCopy copy;
  tell(before, copy);
  fetch(before, copy);
  PublishedTiles after(6, 0.2);
  after.begin_revision();
  const MapTile tile = noise(3);
  after.put("m", {0, 0}, &tile);
  const auto blocks = after.take_changed_blocks({});
  EXPECT_EQ(copy.take(blocks.at(0)).gone.size(), 6u);
  fetch(after, copy);
  EXPECT_EQ(copy.views().at(0).tiles.size(), 1u);
}

// Index and answers come by different ways, so either may overtake the other.
TEST(MapCopy, TakesNoTileThatIsGoneSinceItWasSent) {
  PublishedTiles tiles = row_of(1, 5);
  MapCopy copy;
  tell(tiles, copy);
  const TileAnswer late = tiles.answer(*copy.next_request(0.0, 0.0, kBudget));
  tiles.begin_revision();
  tiles.put("m", {1, 0}, nullptr);
  tell(tiles, copy);
  ASSERT_TRUE(copy.take(late));
  EXPECT_EQ(copy.views().at(0).tiles.size(), 4u);
  EXPECT_FALSE(copy.views().at(0).tiles.contains({1, 0}));
}

TEST(MapCopy, RefusesTilesThatCannotBeRead) {
  PublishedTiles tiles = row_of(1, 1);
  MapCopy copy;
  tell(tiles, copy);
  TileAnswer answer = tiles.answer(*copy.next_request(0.0, 0.0, kBudget));
  answer.tiles.at(0).cells.resize(20);
  EXPECT_FALSE(copy.take(answer));
  answer.tiles.at(0).cells = "no gzip";
  EXPECT_FALSE(copy.take(answer));
  EXPECT_EQ(copy.views().at(0).missing, 1u);
  EXPECT_EQ(fetch(tiles, copy).size(), 1u);
}

TEST(PublishedTiles, RefusesWhatDoesNotExist) {
  const PublishedTiles tiles = row_of(1, 3);
  TileRequest request{.client = 7, .number = 8, .run = 1, .map = "n", .budget_bytes = kBudget};
  const TileAnswer unknown = tiles.answer(request);
  EXPECT_EQ(unknown.error, ErrorCode::kUsage);
  EXPECT_EQ(unknown.reason, "there is no map 'n'; tile_index names those there are");
  EXPECT_EQ(unknown.client, 7u);
  EXPECT_EQ(unknown.number, 8u);
  request.run = 2;
  EXPECT_EQ(tiles.answer(request).error, ErrorCode::kNotUsable);
  EXPECT_EQ(tiles.answer(request).run, 1);
}

}  // namespace
}  // namespace cairn
