// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "cairn/geometry/se2.hpp"
#include "cairn/graph/node_id.hpp"

namespace cairn {

/// A keyframe as seen from another one.
struct Sighting {
  NodeId from, to;
  Se2 T_from_to;
  Eigen::Matrix3d information;  ///< of T_from_to (m, rad)
};

/// What ties two maps, or two ends of one that may be far off: so many sightings that say the same,
/// over so long a way at either end, and no other story that has more than this share of them.
/// Corners of corridors look alike.
struct LoopStoryOptions {
  std::size_t least_agreeing = 8;
  double least_way_m = 12.0;
  double most_doubt = 0.34;
  double agree_m = 0.5, agree_rad = 0.1;  ///< from one sighting to the next
};

/// Keeps sightings that come from looks alone until enough of them tell one story. Those of one
/// object are all between the same two frames; within one frame, from older keyframes to newer.
class LoopStories {
 public:
  struct Map {
    std::function<Se2(const NodeId&)> pose_of;                  ///< T_map_body
    std::function<bool(const Sighting& newest)> contradicts{};  ///< none: nothing does
  };
  explicit LoopStories(const LoopStoryOptions& options = {}) : options_(options) {}

  /// What is to be believed now that was not before.
  std::vector<Sighting> hear(const Sighting& sighting, const Map& map);

  /// The map of the greater frame in that of the smaller one. Within one frame: what older poses
  /// are to be moved by, from the left, to lie where the newer ones put them.
  static Se2 first_map_second_map(const Sighting& sighting, const Map& map);

 private:
  struct Story {
    std::vector<Sighting> sightings;
    bool told = false;  ///< all but the newest are submitted
  };
  [[nodiscard]] bool agree(const Sighting& a, const Sighting& b, const Map& map) const;
  [[nodiscard]] bool convinces(const Story& story, const Map& map) const;

  LoopStoryOptions options_;
  std::vector<Story> stories_;
};

}  // namespace cairn
