// SPDX-License-Identifier: BSD-3-Clause
#include "server/published_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace cairn {
namespace {

constexpr std::size_t kAroundTile = 32;  // bytes beside its cells in an answer

std::int32_t block_of(std::int32_t tile) { return tile >> 3; }
static_assert(kBlockTiles == 1 << 3);

}  // namespace

bool PublishedTiles::put(const std::string& map, const TileIndex& index, const MapTile* tile) {
  Layer& layer = maps_[map];
  const auto known = layer.find(index);
  if (tile == nullptr && known == layer.end()) return false;
  const ContentHash content = tile != nullptr ? hash_of(*tile) : ContentHash{};
  if (known != layer.end() && known->second.content == content) return false;
  Tile& published = layer[index];
  bytes_ -= published.cells.size();
  tiles_ -= !published.cells.empty();
  published = {revision_, content, tile != nullptr ? encode(*tile) : std::string()};
  bytes_ += published.cells.size();
  tiles_ += !published.cells.empty();
  changed_.insert({map, {block_of(index.x), block_of(index.y)}});
  return true;
}

std::vector<TileBlock> PublishedTiles::take_changed_blocks(const EstimateRevisions& estimate) {
  std::vector<TileBlock> blocks;
  for (const auto& [map, at] : std::exchange(changed_, {})) {
    TileBlock block{.map = map,
                    .x = at.x,
                    .y = at.y,
                    .run = run_,
                    .resolution_m = resolution_m_,
                    .estimate = estimate,
                    .tiles = {}};
    const Layer& layer = maps_[map];
    for (std::int32_t y = kBlockTiles * at.y; y < kBlockTiles * (at.y + 1); ++y) {
      const std::int32_t first = kBlockTiles * at.x;
      for (auto tile = layer.lower_bound({first, y});
           tile != layer.end() && tile->first.y == y && tile->first.x < first + kBlockTiles; ++tile)
        block.tiles.push_back({tile->first, tile->second.revision, tile->second.content});
    }
    blocks.push_back(std::move(block));
  }
  return blocks;
}

std::vector<PublishedTiles::Candidate> PublishedTiles::new_to(const TileRequest& request,
                                                              const Layer& layer) const {
  std::map<TileIndex, std::uint64_t> known;
  for (const KnownTile& tile : request.known) known[tile.tile] = tile.revision;
  // The request's position, in cells; where it is absurd, distances are alike absurd.
  const double x = request.x_m / resolution_m_, y = request.y_m / resolution_m_;
  std::vector<Candidate> candidates;
  for (const auto& [index, tile] : layer) {
    if (tile.revision <= request.known_up_to || tile.cells.empty()) continue;
    const auto told = known.find(index);
    if (told != known.end() && told->second == tile.revision) continue;
    const double to_x = kTileCells * (index.x + 0.5) - x, to_y = kTileCells * (index.y + 0.5) - y;
    candidates.push_back({to_x * to_x + to_y * to_y, index, &tile});
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.distance2, a.index) < std::tie(b.distance2, b.index);
  });
  return candidates;
}

TileAnswer PublishedTiles::answer(const TileRequest& request) const {
  TileAnswer answer{.client = request.client,
                    .number = request.number,
                    .run = run_,
                    .map = request.map,
                    .error = {},
                    .reason = {},
                    .tiles = {}};
  const auto refuse = [&](ErrorCode code, std::string reason) {
    answer.error = code;
    answer.reason = std::move(reason);
    return answer;
  };
  if (request.run != run_)
    return refuse(ErrorCode::kNotUsable,
                  "these revisions are of another run of the daemon; ask with those of tile_index");
  const auto layer = maps_.find(request.map);
  if (layer == maps_.end())
    return refuse(ErrorCode::kUsage,
                  "there is no map '" + request.map + "'; tile_index names those there are");
  std::size_t bytes = 0;
  for (const Candidate& next : new_to(request, layer->second)) {
    bytes += next.tile->cells.size() + kAroundTile;
    if (bytes > request.budget_bytes || answer.tiles.size() == limits::kTilesOfAnswer) break;
    answer.tiles.push_back({next.index, next.tile->revision, next.tile->cells});
  }
  return answer;
}

}  // namespace cairn
