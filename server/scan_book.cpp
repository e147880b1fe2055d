// SPDX-License-Identifier: BSD-3-Clause
#include "server/scan_book.hpp"

#include <utility>

#include "cairn/factors/factor_codec.hpp"
#include "cairn/graph/ground_pose.hpp"
#include "cairn/replay/settle.hpp"

namespace cairn {

ScanBook::Placed ScanBook::place(const PoseGraph& graph,
                                 const std::map<OdometryFrame, std::string>& map_of,
                                 bool look_for_missing) {
  Placed placed;
  for (const NodeIndex node : nodes_that_count(graph)) {
    const StoredNode& stored = graph.nodes[node];
    const auto map = map_of.find(stored.id.frame);
    if (!is_pose(stored.type) || map == map_of.end()) continue;
    for (const ContentHash& payload : stored.payloads) {
      const auto [known, is_new] = ids_.try_emplace({node, payload}, entries_.size());
      if (is_new) entries_.push_back({payload});
      const State state = entries_[known->second].state;
      if (state == State::kNoScan || (state == State::kMissing && !look_for_missing)) continue;
      const Estimate& pose = graph.estimates[node];
      placed[map->second].push_back(
          {known->second, ground_pose({pose.data(), value_numbers(stored.type)})});
    }
  }
  return placed;
}

std::shared_ptr<const RangeScan> ScanBook::read(ScanId scan) {
  Entry& entry = entries_[scan];
  const Result<std::string> bytes = journal_.read_payload(entry.payload);
  if (!bytes) return set(entry, State::kMissing), nullptr;
  Result<RangeScan> decoded = decode_range_scan(*bytes);
  if (!decoded) return set(entry, State::kNoScan), nullptr;  // an image, say
  set(entry, State::kFound);
  return std::make_shared<RangeScan>(std::move(*decoded));
}

void ScanBook::set(Entry& entry, State state) {
  const State before = std::exchange(entry.state, state);
  missing_ += state == State::kMissing;
  missing_ -= before == State::kMissing;
}

}  // namespace cairn
