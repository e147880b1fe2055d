// SPDX-License-Identifier: BSD-3-Clause
#include "idl/convert_map.hpp"

#include <algorithm>
#include <cmath>

#include "idl/wire_checks.hpp"

namespace cairn::wire {
namespace {

TileIndex read_tile_index(Checks& checks, std::int32_t x, std::int32_t y) {
  constexpr std::int32_t kMost = limits::kFarthestTile;
  if (x < -kMost || x > kMost || y < -kMost || y > kMost)
    checks.fail("tile (" + std::to_string(x) + ", " + std::to_string(y) +
                ") lies beyond the grid; expected up to " + std::to_string(kMost));
  return {x, y};
}

// Where a tile is in its block, row by row.
std::uint8_t place_of(const TileBlock& block, const TileIndex& tile) {
  return static_cast<std::uint8_t>((tile.x - kBlockTiles * block.x) +
                                   kBlockTiles * (tile.y - kBlockTiles * block.y));
}

}  // namespace

cairn_wire_Tile_index to_wire(const TileBlock& block, Arena& arena) {
  cairn_wire_Tile_index wire{};
  wire.map_name = lend(block.map);
  wire.x = block.x;
  wire.y = block.y;
  wire.version = kVersion;
  wire.run = block.run;
  wire.resolution_m = block.resolution_m;
  wire.revisions = to_wire(block.estimate);
  auto* entry = make_sequence(wire.tiles, block.tiles.size(), arena);
  for (const TileEntry& tile : block.tiles) {
    *entry = {.place = place_of(block, tile.tile), .revision = tile.revision, .content = {}};
    std::copy(tile.content.begin(), tile.content.end(), entry->content);
    ++entry;
  }
  return wire;
}

Result<TileBlock> from_wire(const cairn_wire_Tile_index& wire) {
  Checks checks;
  checks.version(wire.version);
  TileBlock block{.map = checks.name("map", wire.map_name),
                  .x = wire.x,
                  .y = wire.y,
                  .run = wire.run,
                  .resolution_m = wire.resolution_m,
                  .estimate = from_wire(wire.revisions),
                  .tiles = {}};
  constexpr std::int32_t kMost = limits::kFarthestTile / kBlockTiles;
  if (std::abs(std::int64_t{wire.x}) > kMost || std::abs(std::int64_t{wire.y}) > kMost)
    checks.fail("the block lies beyond the grid");
  if (!(wire.resolution_m >= 1e-3 && wire.resolution_m <= 1e3))
    checks.fail("resolution is no number from 0.001 to 1000 m");
  if (!checks.count("tiles", wire.tiles._length, limits::kTilesOfBlock) || !checks.ok())
    return checks.result(std::move(block));
  int last = -1;
  for (std::uint32_t i = 0; i < wire.tiles._length; ++i) {
    const cairn_wire_Tile_entry& entry = wire.tiles._buffer[i];
    if (entry.place >= limits::kTilesOfBlock || entry.place <= last)
      checks.fail("places of tiles do not ascend from 0 to 63");
    last = entry.place;
    TileEntry tile{{kBlockTiles * wire.x + entry.place % kBlockTiles,
                    kBlockTiles * wire.y + entry.place / kBlockTiles},
                   entry.revision,
                   {}};
    std::copy_n(entry.content, tile.content.size(), tile.content.begin());
    block.tiles.push_back(tile);
  }
  return checks.result(std::move(block));
}

cairn_wire_Tile_request to_wire(const TileRequest& request, Arena& arena) {
  cairn_wire_Tile_request wire{};
  wire.client = request.client;
  wire.version = kVersion;
  wire.number = request.number;
  wire.run = request.run;
  wire.map_name = lend(request.map);
  wire.position[0] = request.x_m;
  wire.position[1] = request.y_m;
  wire.budget_bytes = request.budget_bytes;
  wire.known_up_to = request.known_up_to;
  auto* known = make_sequence(wire.known, request.known.size(), arena);
  for (const KnownTile& tile : request.known)
    *known++ = {.x = tile.tile.x, .y = tile.tile.y, .revision = tile.revision};
  return wire;
}

Result<TileRequest> from_wire(const cairn_wire_Tile_request& wire) {
  Checks checks;
  checks.version(wire.version);
  TileRequest request{.client = wire.client,
                      .number = wire.number,
                      .run = wire.run,
                      .map = checks.name("map", wire.map_name),
                      .x_m = wire.position[0],
                      .y_m = wire.position[1],
                      .budget_bytes = wire.budget_bytes,
                      .known_up_to = wire.known_up_to,
                      .known = {}};
  if (!std::isfinite(request.x_m) || !std::isfinite(request.y_m))
    checks.fail("position is not finite");
  if (request.budget_bytes < limits::kLeastTileBudget ||
      request.budget_bytes > limits::kMostTileBudget)
    checks.fail("budget is " + std::to_string(request.budget_bytes) + " bytes; expected " +
                std::to_string(limits::kLeastTileBudget) + " to " +
                std::to_string(limits::kMostTileBudget));
  if (checks.count("known tiles", wire.known._length, limits::kKnownTiles))
    for (std::uint32_t i = 0; i < wire.known._length; ++i) {
      const cairn_wire_Known_tile& known = wire.known._buffer[i];
      request.known.push_back({read_tile_index(checks, known.x, known.y), known.revision});
    }
  return checks.result(std::move(request));
}

cairn_wire_Occupancy_tile to_wire(const TileAnswer& answer, Arena& arena) {
  cairn_wire_Occupancy_tile wire{};
  wire.client = answer.client;
  wire.version = kVersion;
  wire.number = answer.number;
  wire.run = answer.run;
  wire.map_name = lend(answer.map);
  wire.error_code = answer.error ? static_cast<std::uint8_t>(*answer.error) : 0;
  wire.reason = lend_cut(answer.reason, limits::kReason, arena);
  auto* sent = make_sequence(wire.tiles, answer.tiles.size(), arena);
  for (const SentTile& tile : answer.tiles) {
    *sent = {.x = tile.tile.x, .y = tile.tile.y, .revision = tile.revision, .cells = {}};
    sent->cells._maximum = sent->cells._length = static_cast<std::uint32_t>(tile.cells.size());
    sent->cells._buffer =
        const_cast<std::uint8_t*>(reinterpret_cast<const std::uint8_t*>(tile.cells.data()));
    ++sent;
  }
  return wire;
}

Result<TileAnswer> from_wire(const cairn_wire_Occupancy_tile& wire) {
  Checks checks;
  checks.version(wire.version);
  TileAnswer answer{.client = wire.client,
                    .number = wire.number,
                    .run = wire.run,
                    .map = checks.optional_name("map", wire.map_name),
                    .error = {},
                    .reason = checks.text("reason", wire.reason, limits::kReason),
                    .tiles = {}};
  if (wire.error_code != 0) answer.error = static_cast<ErrorCode>(wire.error_code);
  if (checks.count("tiles", wire.tiles._length, limits::kTilesOfAnswer))
    for (std::uint32_t i = 0; i < wire.tiles._length; ++i) {
      const cairn_wire_Sent_tile& sent = wire.tiles._buffer[i];
      SentTile tile{read_tile_index(checks, sent.x, sent.y), sent.revision, {}};
      if (checks.count("bytes of a tile", sent.cells._length, limits::kTileBytes))
        tile.cells.assign(reinterpret_cast<const char*>(sent.cells._buffer), sent.cells._length);
      answer.tiles.push_back(std::move(tile));
    }
  return checks.result(std::move(answer));
}

}  // namespace cairn::wire
