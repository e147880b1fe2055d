// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cairn/maps/map_tile.hpp"
#include "idl/messages.hpp"

/// How maps travel: an index that everybody hears, and tiles for those who ask.
namespace cairn {

/// A tile in the index.
struct TileEntry {
  TileIndex tile{};
  std::uint64_t revision = 0;  ///< rises when the content changes; of one run of the daemon
  ContentHash content{};       ///< hash_of() its cells; zeros: it is gone

  [[nodiscard]] bool is_gone() const { return content == ContentHash{}; }
  friend bool operator==(const TileEntry&, const TileEntry&) = default;
};

constexpr std::int32_t kBlockTiles = 8;  ///< tiles along one side of a block

/// Daemon to all, latest kept: every tile of a block that some rendering has touched.
struct TileBlock {
  std::string map{};        ///< as PoseChunk::map
  std::int32_t x = 0;       ///< tiles 8 x to 8 x + 7
  std::int32_t y = 0;       ///< and the same for y
  std::int64_t run = 0;     ///< which run of the daemon counts the revisions: its start
  double resolution_m = 0;  ///< side of a cell
  EstimateRevisions estimate{};
  std::vector<TileEntry> tiles{};  ///< row by row

  friend bool operator==(const TileBlock&, const TileBlock&) = default;
};

struct KnownTile {
  TileIndex tile{};
  std::uint64_t revision = 0;

  friend bool operator==(const KnownTile&, const KnownTile&) = default;
};

/// Client to daemon: the tiles that it does not know, nearest first, as many as fit.
struct TileRequest {
  std::uint64_t client = 0;  ///< random: this run of the client
  std::uint64_t number = 0;
  std::int64_t run = 0;
  std::string map{};
  double x_m = 0.0, y_m = 0.0;
  std::uint32_t budget_bytes = 0;
  std::uint64_t known_up_to = 0;   ///< tiles of this revision, and of those before, are known
  std::vector<KnownTile> known{};  ///< newer ones that are known as well

  friend bool operator==(const TileRequest&, const TileRequest&) = default;
};

struct SentTile {
  TileIndex tile{};
  std::uint64_t revision = 0;
  std::string cells{};  ///< of encode()

  friend bool operator==(const SentTile&, const SentTile&) = default;
};

/// The answer to one request: nothing in it where everything is known.
struct TileAnswer {
  std::uint64_t client = 0;
  std::uint64_t number = 0;
  std::int64_t run = 0;  ///< of the daemon that answers, also where it refuses
  std::string map{};
  std::optional<ErrorCode> error{};
  std::string reason{};
  std::vector<SentTile> tiles{};

  friend bool operator==(const TileAnswer&, const TileAnswer&) = default;
};

/// What has changed in one map. Frames of odometry that nothing ties have maps of their own.
struct MapChange {
  std::string map{};             ///< as PoseChunk::map
  EstimateRevisions estimate{};  ///< that it was rendered from
  double resolution_m = 0.0;     ///< side of a cell
  /// The tiles that are different now, whole. Tile (x, y) has the cells from (64 x, 64 y) on; cell
  /// (0, 0) has its lower left corner at the map's origin.
  std::map<TileIndex, MapTile> changed{};
  /// Tiles of which no scan says anything any more, as when two maps became one.
  std::vector<TileIndex> gone{};
};

namespace limits {
constexpr std::uint32_t kLeastTileBudget = 8u << 10, kMostTileBudget = 1u << 20;  ///< bytes
constexpr std::size_t kKnownTiles = 65'536;
constexpr std::size_t kTilesOfBlock = kBlockTiles * kBlockTiles;
constexpr std::size_t kTilesOfAnswer = 16'384;
constexpr std::size_t kTileBytes = 5'000;                       ///< of encode()
constexpr std::int32_t kFarthestTile = (1 << 30) / kTileCells;  ///< as far as grids go
}  // namespace limits

/// One byte per cell, gzip.
std::string encode(const MapTile& tile);
/// The inverse; kBadInput for everything that encode() cannot have made.
Result<MapTile> decode_tile(std::string_view bytes);
/// Of the cells, not of their compression.
ContentHash hash_of(const MapTile& tile);

}  // namespace cairn
