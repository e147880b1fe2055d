// SPDX-License-Identifier: BSD-3-Clause
#include "idl/map_messages.hpp"

#include <algorithm>

#include "cairn/io/compression.hpp"

namespace cairn {
namespace {

std::string_view bytes_of(const MapTile& tile) {
  static_assert(sizeof(MapTile) == kTileArea);
  return {reinterpret_cast<const char*>(tile.data()), tile.size()};
}

}  // namespace

std::string encode(const MapTile& tile) { return compress(bytes_of(tile), Compression::kGzip); }

Result<MapTile> decode_tile(std::string_view bytes) {
  const Result<std::string> cells = decompress(bytes, Compression::kGzip, "tile", kTileArea);
  if (!cells) return cells.error();
  if (cells->size() != kTileArea)
    return Error{ErrorCode::kBadInput, "a tile has " + std::to_string(cells->size()) +
                                           " cells; expected " + std::to_string(kTileArea)};
  MapTile tile;
  for (std::size_t i = 0; i < kTileArea; ++i) {
    const auto cell = static_cast<std::uint8_t>((*cells)[i]);
    if (cell > static_cast<std::uint8_t>(TileCell::kUndecided))
      return Error{ErrorCode::kBadInput, "cell " + std::to_string(i) + " of a tile is " +
                                             std::to_string(cell) + "; expected 0 to 3"};
    tile[i] = static_cast<TileCell>(cell);
  }
  return tile;
}

ContentHash hash_of(const MapTile& tile) { return content_hash(bytes_of(tile)); }

}  // namespace cairn
