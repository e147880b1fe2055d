// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "cairn/graph/pose_graph.hpp"
#include "cairn/journal/journal.hpp"
#include "cairn/maps/map_renderer.hpp"

namespace cairn {

/// Which scans the nodes of a map have: gives each an id that holds as long as the daemon runs
/// (nodes keep their places, payloads their content), and reads it from the journal. One thread.
class ScanBook {
 public:
  explicit ScanBook(const Journal& journal) : journal_(journal) {}

  using Placed = std::map<std::string, std::vector<PlacedScan>>;
  /// The scans by map, at the graph's estimates; `map_of` names the map of a frame. Payloads that
  /// are known to be something else are left out, and those that were missing unless
  /// `look_for_missing`.
  Placed place(const PoseGraph& graph, const std::map<OdometryFrame, std::string>& map_of,
               bool look_for_missing);
  /// Null where it has not come yet, or is no scan.
  std::shared_ptr<const RangeScan> read(ScanId scan);
  /// Payloads that nodes name and that had not come when last looked for.
  [[nodiscard]] std::size_t missing() const { return missing_; }

 private:
  enum class State : std::uint8_t { kFound, kMissing, kNoScan };
  struct Entry {
    ContentHash payload;
    State state = State::kFound;  // unless reading it says otherwise
  };
  void set(Entry& entry, State state);

  const Journal& journal_;
  std::vector<Entry> entries_;  // by id
  std::map<std::pair<NodeIndex, ContentHash>, ScanId> ids_;
  std::size_t missing_ = 0;
};

}  // namespace cairn
