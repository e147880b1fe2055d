// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>
#include <string>

#include "cairn/graph/ground_pose.hpp"
#include "cairn/maps/map_renderer.hpp"
#include "clients/client/client.hpp"
#include "server/replay_journal.hpp"
#include "tests/server/drive.hpp"
#include "tests/support/wait_until.hpp"

namespace cairn::test {

/// What a laser sees at (x, 0), looking along x, of a room from (-3, -4) to (103, 4); the beams are
/// so few that tiles differ from scan to scan.
inline std::string room_scan(double x) {
  constexpr double kStep = 0.05235987755983;
  RangeScan scan{-60 * kStep, kStep, 150.0, Se2(), {}};
  for (int i = 0; i < 120; ++i) {
    const double angle = scan.first_angle_rad + (i + 0.5) * kStep;
    const double to_x = (std::cos(angle) > 0 ? 103.0 - x : -3.0 - x) / std::cos(angle);
    const double to_y = (std::sin(angle) > 0 ? 4.0 : -4.0) / std::sin(angle);
    scan.ranges_m.push_back(static_cast<float>(std::min(to_x, to_y)));
  }
  return *encode(scan);
}

/// Step i of a drive along the room; from the second one on each names the scan that `send` gives
/// the bytes of to whoever stores them.
inline Transaction mapped_step(const std::string& robot, std::uint64_t i,
                               const std::function<void(const std::string&)>& send) {
  Transaction step = drive_step(robot, i);
  if (step.factors.empty()) return step;
  const std::string scan = room_scan(static_cast<double>(i));
  send(scan);
  step.factors.front().payloads.push_back(content_hash(scan));
  return step;
}

/// What rendering all scans of a journal gives at the estimates that it ends with.
inline std::map<TileIndex, MapTile> render_journal(const Journal& journal, double resolution_m) {
  MapHead head;
  Sequencer sequencer;
  EXPECT_TRUE(replay_journal(journal, head, sequencer));
  const PoseGraph& graph = head.graph();
  std::vector<ContentHash> payloads;
  std::vector<PlacedScan> placed;
  for (NodeIndex node = 0; node < graph.nodes.size(); ++node) {
    for (const ContentHash& payload : graph.nodes[node].payloads) {
      placed.push_back({payloads.size(), ground_pose({graph.estimates[node].data(), 3})});
      payloads.push_back(payload);
    }
  }
  LaserMap map(resolution_m);
  map.render(
      placed,
      [&](ScanId id) -> std::shared_ptr<const RangeScan> {
        const auto bytes = journal.read_payload(payloads[id]);
        if (!bytes) return nullptr;
        return std::make_shared<RangeScan>(*decode_range_scan(*bytes));
      },
      Precision::kExact);
  std::map<TileIndex, MapTile> tiles;
  for (const auto& [index, tile] : map.grid())
    tiles.emplace(index, read_tile(tile, MapModel::kOccupancy));
  return tiles;
}

}  // namespace cairn::test
