// SPDX-License-Identifier: BSD-3-Clause
#include "clients/client/map_copy.hpp"

#include <algorithm>
#include <utility>

namespace cairn {
namespace {

constexpr std::size_t kMostRuns = 4;  // of daemons, of which an index may still arrive

}  // namespace

const MapCopy::Held* MapCopy::find(const std::string& map, const TileIndex& tile) const {
  const auto layer = maps_.find(map);
  if (layer == maps_.end()) return nullptr;
  const auto held = layer->second.tiles.find(tile);
  return held == layer->second.tiles.end() ? nullptr : &held->second;
}

// The index may come before an answer that was given earlier.
bool MapCopy::is_gone_since(const std::string& map, const SentTile& sent) const {
  const auto index = runs_.find(run_);
  if (index == runs_.end()) return false;
  const auto tiles = index->second.find(map);
  if (tiles == index->second.end()) return false;
  const auto named = tiles->second.find(sent.tile);
  return named != tiles->second.end() && named->second.is_gone() &&
         named->second.revision > sent.revision;
}

// Nothing where the tile that the index names is missing.
std::optional<std::uint64_t> MapCopy::known_revision(const std::string& map,
                                                     const TileEntry& entry) const {
  if (entry.is_gone()) return entry.revision;
  const Held* held = find(map, entry.tile);
  if (held == nullptr) return std::nullopt;
  if (held->content == entry.content) return entry.revision;
  // Tiles may come before the index that names them.
  if (held->run == run_ && held->revision > entry.revision) return held->revision;
  return std::nullopt;
}

MapChange MapCopy::take(const TileBlock& block) {
  MapChange change{block.map, block.estimate, block.resolution_m, {}, {}};
  auto& index = runs_[block.run][block.map];
  for (const TileEntry& entry : block.tiles) index[entry.tile] = entry;
  run_ = std::max(run_, block.run);
  forget_old_runs();
  if (block.run != run_) return change;
  Layer& layer = maps_[block.map];
  if (std::exchange(layer.resolution_m, block.resolution_m) != block.resolution_m)
    for (const auto& [tile, held] : std::exchange(layer.tiles, {})) change.gone.push_back(tile);
  layer.estimate = block.estimate;
  for (const TileEntry& entry : block.tiles)
    if (entry.is_gone() && layer.tiles.erase(entry.tile) > 0) change.gone.push_back(entry.tile);
  return change;
}

void MapCopy::forget_old_runs() {
  while (runs_.size() > kMostRuns)
    runs_.erase(runs_.begin()->first == run_ ? std::next(runs_.begin()) : runs_.begin());
}

Result<MapChange> MapCopy::take(const TileAnswer& answer) {
  // Where the clock was set back between two runs, only this tells which one lives.
  if (runs_.contains(answer.run)) run_ = answer.run;
  Layer* layer = nullptr;
  if (const auto found = maps_.find(answer.map); found != maps_.end()) layer = &found->second;
  MapChange change{answer.map, {}, 0.0, {}, {}};
  if (layer == nullptr || answer.run != run_ || answer.error) return change;
  change.estimate = layer->estimate;
  change.resolution_m = layer->resolution_m;
  std::optional<Error> fault;
  for (const SentTile& sent : answer.tiles) {
    const Held* before = find(answer.map, sent.tile);
    if (before != nullptr && before->run == run_ && before->revision >= sent.revision) continue;
    if (is_gone_since(answer.map, sent)) continue;
    const Result<MapTile> cells = decode_tile(sent.cells);
    if (!cells) {
      fault = cells.error();
      continue;
    }
    layer->tiles.insert_or_assign(sent.tile, Held{*cells, hash_of(*cells), sent.revision, run_});
    change.changed.emplace(sent.tile, *cells);
  }
  if (fault && change.changed.empty()) return *fault;
  return change;
}

std::optional<TileRequest> MapCopy::request_for(const std::string& map,
                                                const std::map<TileIndex, TileEntry>& index) const {
  std::uint64_t oldest_missing = UINT64_MAX;
  for (const auto& [tile, entry] : index)
    if (!known_revision(map, entry)) oldest_missing = std::min(oldest_missing, entry.revision);
  if (oldest_missing == UINT64_MAX) return std::nullopt;
  TileRequest request;
  request.run = run_;
  request.map = map;
  request.known_up_to = oldest_missing == 0 ? 0 : oldest_missing - 1;
  for (const auto& [tile, entry] : index) {
    const auto known = known_revision(map, entry);
    if (known && *known > request.known_up_to && !entry.is_gone() &&
        request.known.size() < limits::kKnownTiles)
      request.known.push_back({tile, *known});
  }
  return request;
}

std::optional<TileRequest> MapCopy::next_request(double x_m, double y_m,
                                                 std::uint32_t budget_bytes) const {
  const auto index = runs_.find(run_);
  if (index == runs_.end()) return std::nullopt;
  for (const auto& [map, tiles] : index->second) {
    auto request = request_for(map, tiles);
    if (!request) continue;
    request->x_m = x_m;
    request->y_m = y_m;
    request->budget_bytes = budget_bytes;
    return request;
  }
  return std::nullopt;
}

std::vector<MapChange> MapCopy::prune() {
  std::vector<MapChange> changes;
  const Index& index = runs_[run_];
  for (auto& [name, layer] : maps_) {
    MapChange change{name, layer.estimate, layer.resolution_m, {}, {}};
    const auto named = index.find(name);
    std::erase_if(layer.tiles, [&](const auto& tile) {
      if (tile.second.run == run_ || (named != index.end() && named->second.contains(tile.first)))
        return false;
      change.gone.push_back(tile.first);
      return true;
    });
    if (!change.gone.empty()) changes.push_back(std::move(change));
  }
  std::erase_if(maps_, [](const auto& map) { return map.second.tiles.empty(); });
  return changes;
}

std::vector<MapView> MapCopy::views() const {
  std::vector<MapView> views;
  const auto index = runs_.find(run_);
  for (const auto& [name, layer] : maps_) {
    MapView view{name, layer.resolution_m, layer.estimate, {}, 0};
    for (const auto& [tile, held] : layer.tiles) view.tiles.emplace(tile, held.cells);
    const auto named = index == runs_.end() ? Index::const_iterator() : index->second.find(name);
    if (index != runs_.end() && named != index->second.end())
      for (const auto& [tile, entry] : named->second) view.missing += !known_revision(name, entry);
    if (!view.tiles.empty() || view.missing > 0) views.push_back(std::move(view));
  }
  return views;
}

}  // namespace cairn
