// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "idl/map_messages.hpp"

namespace cairn {

/// One map as a client has it.
struct MapView {
  std::string map{};  ///< as PoseChunk::map
  double resolution_m = 0.0;
  EstimateRevisions estimate{};  ///< of the newest index; the tiles are of it where none is missing
  std::map<TileIndex, MapTile> tiles{};
  std::size_t missing = 0;  ///< tiles that the index names and that are not here, or older
};

/// A client's copy of the daemon's maps: what the index says, the tiles that are here, and what is
/// to be asked for. Knows tiles of another run of the daemon by their hashes. A value; one thread.
class MapCopy {
 public:
  /// What the index takes away or, where it is finer or coarser now, all that was there.
  MapChange take(const TileBlock& block);
  /// The tiles that are new. kBadInput where one cannot be read; the others are taken.
  Result<MapChange> take(const TileAnswer& answer);
  /// The next question, without client and number; nothing where nothing is missing.
  [[nodiscard]] std::optional<TileRequest> next_request(double x_m, double y_m,
                                                        std::uint32_t budget_bytes) const;
  /// Removes tiles that the index does not name: of a run before. Only when it has come whole.
  std::vector<MapChange> prune();
  [[nodiscard]] std::vector<MapView> views() const;

 private:
  struct Held {
    MapTile cells;
    ContentHash content;
    std::uint64_t revision;
    std::int64_t run;
  };
  struct Layer {
    double resolution_m = 0.0;
    EstimateRevisions estimate{};
    std::map<TileIndex, Held> tiles{};
  };
  using Index = std::map<std::string, std::map<TileIndex, TileEntry>>;

  [[nodiscard]] const Held* find(const std::string& map, const TileIndex& tile) const;
  [[nodiscard]] bool is_gone_since(const std::string& map, const SentTile& sent) const;
  [[nodiscard]] std::optional<std::uint64_t> known_revision(const std::string& map,
                                                            const TileEntry& entry) const;
  [[nodiscard]] std::optional<TileRequest> request_for(
      const std::string& map, const std::map<TileIndex, TileEntry>& index) const;
  void forget_old_runs();

  std::map<std::int64_t, Index> runs_;  // what daemons said that were here one after the other
  std::int64_t run_ = 0;                // that is believed: the newest, or who has answered
  std::map<std::string, Layer> maps_;
};

}  // namespace cairn
