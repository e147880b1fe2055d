// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cairn/core/result.hpp"
#include "cairn/geometry/se3.hpp"
#include "cairn/graph/graph.hpp"

namespace cairn {

enum class TrajectoryFormat { kTum, kKitti, kGraph };

/// One pose and what names it: a stamp in ns (TUM), the line's index from 0 (KITTI), or the id
/// (graph files).
struct TrajectoryPose {
  std::uint64_t key;
  Se3 T_world_body;
};

/// Poses in order of the file (TUM, KITTI) or of their ids (graph files).
struct Trajectory {
  std::string name;  ///< of the file, for messages
  TrajectoryFormat format = TrajectoryFormat::kTum;
  bool planar = false;  ///< from SE(2) poses: z, roll and pitch are zero
  std::vector<TrajectoryPose> poses{};
  std::vector<std::string> warnings{};  ///< "file:line:column: message"
};

/// Reads TUM (`stamp tx ty tz qx qy qz qw`, s and m), KITTI (12 numbers, the upper 3 x 4 of
/// T_world_body row by row) or the poses of a graph file, told apart by content. `path` as in
/// read_graph(). Errors name file:line:column.
Result<Trajectory> read_trajectory(const std::string& path);

/// Reads TUM or KITTI from memory; `name` stands for the file in messages.
Result<Trajectory> read_trajectory_text(std::string_view text, const std::string& name);

/// What the text's first line looks like; nothing when it is neither. An empty text is kTum.
std::optional<TrajectoryFormat> recognize_trajectory(std::string_view text);

/// The poses of a graph, SE(2) or SE(3), in order of their ids.
Trajectory trajectory_of(const Graph& graph, const std::string& name);

}  // namespace cairn
