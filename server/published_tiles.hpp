// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "idl/map_messages.hpp"

namespace cairn {

/// The tiles that clients may ask for, compressed, with their revisions. A value; one thread.
class PublishedTiles {
 public:
  /// `run` names this run of the daemon.
  PublishedTiles(std::int64_t run, double resolution_m) : run_(run), resolution_m_(resolution_m) {}

  /// What put() says from now on has a higher revision than what it said before.
  void begin_revision() { ++revision_; }
  /// The tile as it is now; null: no scan says anything of it. False where that is no news.
  bool put(const std::string& map, const TileIndex& index, const MapTile* tile);
  /// The blocks of the index in which something has changed since the last call.
  std::vector<TileBlock> take_changed_blocks(const EstimateRevisions& estimate);
  /// What is new to whoever asks: nearest tiles first, as many as fit into the budget. An error
  /// says what was wrong with the request.
  [[nodiscard]] TileAnswer answer(const TileRequest& request) const;

  [[nodiscard]] std::size_t tiles() const { return tiles_; }  ///< without those that are gone
  [[nodiscard]] std::size_t bytes() const { return bytes_; }  ///< of their compressed cells
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

 private:
  struct Tile {
    std::uint64_t revision = 0;
    ContentHash content{};  // zeros: gone
    std::string cells{};
  };
  using Layer = std::map<TileIndex, Tile>;
  struct Candidate {
    double distance2;  // cells
    TileIndex index;
    const Tile* tile;
  };
  [[nodiscard]] std::vector<Candidate> new_to(const TileRequest& request, const Layer& layer) const;

  std::int64_t run_;
  double resolution_m_;
  std::uint64_t revision_ = 0;
  std::map<std::string, Layer> maps_;
  std::set<std::pair<std::string, TileIndex>> changed_;  // blocks, by map
  std::size_t tiles_ = 0, bytes_ = 0;
};

}  // namespace cairn
