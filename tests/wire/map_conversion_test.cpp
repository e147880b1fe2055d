// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "cairn/io/compression.hpp"
#include "idl/convert_map.hpp"
#include "tests/wire/messages.hpp"

namespace cairn {
namespace {

using testing::HasSubstr;

template <class Message>
Message round_trip(const Message& message) {
  wire::Arena arena;
  auto result = wire::from_wire(wire::to_wire(message, arena));
  EXPECT_TRUE(result) << (result ? "" : result.error().message);
  return result ? *result : Message{};
}

template <class Message>
std::string refusal(const Message& message) {
  wire::Arena arena;
  const auto result = wire::from_wire(wire::to_wire(message, arena));
  EXPECT_FALSE(result);
  return result ? "" : result.error().message;
}

TileRequest request() {
  return {.client = 7,
          .number = 8,
          .run = 9,
          .map = "robot/3",
          .x_m = -1.5,
          .y_m = 2.5,
          .budget_bytes = 10'000,
          .known_up_to = 11,
          .known = {{{-3, 4}, 12}, {{5, -6}, 13}}};
}

TEST(MapConversion, CarriesEveryField) {
  TileBlock block{.map = "robot/3",
                  .x = -1,
                  .y = 2,
                  .run = 9,
                  .resolution_m = 0.05,
                  .estimate = test::revisions(3, 2),
                  .tiles = {}};
  block.tiles.push_back({{-8, 16}, 4, content_hash("a")});
  block.tiles.push_back({{-1, 23}, 5, {}});
  EXPECT_EQ(round_trip(block), block);
  EXPECT_TRUE(block.tiles[1].is_gone());
  EXPECT_EQ(round_trip(request()), request());
  const TileAnswer answer{.client = 7,
                          .number = 8,
                          .run = 9,
                          .map = "m",
                          .error = ErrorCode::kUsage,
                          .reason = "why",
                          .tiles = {{{1, -2}, 3, std::string("a\0b", 3)}}};
  EXPECT_EQ(round_trip(answer), answer);
}

TEST(MapConversion, RefusesRequestsThatBreakTheRules) {
  TileRequest bad = request();
  bad.budget_bytes = 8191;
  EXPECT_EQ(refusal(bad), "budget is 8191 bytes; expected 8192 to 1048576");
  bad.budget_bytes = (1u << 20) + 1;
  EXPECT_THAT(refusal(bad), HasSubstr("expected 8192 to 1048576"));
  bad = request();
  bad.x_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal(bad), "position is not finite");
  bad = request();
  bad.map.assign(65, 'x');
  EXPECT_THAT(refusal(bad), HasSubstr("map"));
  bad = request();
  bad.known[1].tile.x = limits::kFarthestTile + 1;
  EXPECT_THAT(refusal(bad), HasSubstr("lies beyond the grid"));
  bad = request();
  bad.known.resize(limits::kKnownTiles + 1);
  EXPECT_THAT(refusal(bad), HasSubstr("known tiles"));
}

TEST(MapConversion, RefusesIndexesAndAnswersThatBreakTheRules) {
  TileBlock block{.map = "m", .resolution_m = 0.05, .tiles = {{{0, 0}, 1, {}}, {{0, 0}, 2, {}}}};
  EXPECT_EQ(refusal(block), "places of tiles do not ascend from 0 to 63");
  block.tiles.clear();
  block.resolution_m = 0.0;
  EXPECT_THAT(refusal(block), HasSubstr("resolution"));
  block.resolution_m = 0.05;
  block.x = 1 << 30;
  EXPECT_THAT(refusal(block), HasSubstr("beyond the grid"));
  TileAnswer answer{.tiles = {{{0, 0}, 1, std::string(limits::kTileBytes + 1, 'x')}}};
  EXPECT_THAT(refusal(answer), HasSubstr("bytes of a tile"));
}

TEST(Tile, IsReadAsItWasWritten) {
  MapTile tile{};
  for (std::size_t i = 0; i < tile.size(); ++i) tile[i] = static_cast<TileCell>(i * i / 7 % 4);
  const std::string bytes = encode(tile);
  EXPECT_LE(bytes.size(), limits::kTileBytes);
  ASSERT_TRUE(decode_tile(bytes));
  EXPECT_EQ(*decode_tile(bytes), tile);
  EXPECT_NE(hash_of(tile), hash_of(MapTile{}));
}

TEST(Tile, RefusesWhatIsNone) {
  const auto gzip = [](const std::string& text) { return compress(text, Compression::kGzip); };
  EXPECT_FALSE(decode_tile(""));
  EXPECT_FALSE(decode_tile("text"));
  EXPECT_FALSE(decode_tile(gzip(std::string(4095, '\0'))));
  EXPECT_FALSE(decode_tile(gzip(std::string(4097, '\0'))));
  EXPECT_FALSE(decode_tile(gzip(std::string(1 << 20, '\0'))));
  std::string cells(4096, '\3');
  EXPECT_TRUE(decode_tile(gzip(cells)));
  cells[17] = '\4';
  const auto refused = decode_tile(gzip(cells));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "cell 17 of a tile is 4; expected 0 to 3");
}

}  // namespace
}  // namespace cairn
