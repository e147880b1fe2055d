// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "cairn/maps/map_image.hpp"
#include "clients/cli/target.hpp"

namespace cairn::cli {

/// Which map is asked for.
struct MapQuestion {
  double resolution_m = 0.05;
  std::string model = "occupancy", robot{};  ///< of all robots where none is named
  bool live = false;        ///< by the estimate that the daemon publishes; else settled
  bool with_graph = false;  ///< its trajectories and loops, too
};

/// Adds --resolution, --model and --robot.
void add_map_question(CLI::App& verb, MapQuestion& question);

struct ReceivedMap {
  MapImage image;
  std::size_t scans = 0, missing = 0;  ///< missing: named by a keyframe, and not come
  std::string graph;                   ///< g2o, where it was asked for
};

/// From a daemon, or a folder. kNotUsable where it has no scans.
Result<ReceivedMap> ask_for_map(const Target& target, const MapQuestion& question);

}  // namespace cairn::cli
