// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "cairn/history/question.hpp"

namespace cairn {

/// Files that an answer holds: name and content.
using NamedFiles = std::vector<std::pair<std::string, std::string>>;

/// As one text: a line of JSON with names and lengths, then the contents.
std::string join_files(const NamedFiles& files);
Result<NamedFiles> split_files(const std::string& text);

/// The enabled part of a map as a graph file, "graph", and what its ids mean, "ids": CSV
/// `id,robot,epoch,index`. Vertices in canonical order. Nodes that came from files (epoch 0) keep
/// the file's id where no other node has it; the others get the smallest free ones. With the
/// settled estimate or, with the option live, what the daemon publishes. kNotUsable where the map
/// cannot be settled.
Result<std::string> answer_export_graph(const Question& question, const Asked& asked);
/// One TUM file per robot, named after it: `time x y z qx qy qz qw` of T_map_body (s, m). Time is
/// the pose's stamp or, where a robot's poses have none, the index (the place along the trajectory
/// where it has several epochs). Options: robot, live.
Result<std::string> answer_export_trajectory(const Question& question, const Asked& asked);
/// The occupancy map that the laser scans of the poses make: "map" (history/map_text.hpp), "counts"
/// (JSON: scans in it, payloads missing) and, with the option with_graph, "graph" as above.
/// Options: resolution (m per cell), model (occupancy, reflection), robot, live. kNotUsable where
/// there are no scans.
Result<std::string> answer_export_map(const Question& question, const Asked& asked);

}  // namespace cairn
