// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cairn/replay/map_head.hpp"
#include "server/transport.hpp"

namespace cairn {

/// Cuts the live estimate into chunks of trajectories and landmarks, and sends those that changed,
/// with where each robot's odometry frame lies now.
/// One thread.
class EstimatePublisher {
 public:
  /// Told of a correction that moves a robot by more than this, before anything of it is published.
  struct Jumps {
    double m;
    double rad;
    std::function<void(const Correction&)> tell;
  };

  EstimatePublisher(Transport& transport, Jumps jumps)
      : transport_(transport), jumps_(std::move(jumps)) {}

  /// Publishes what differs from what was published last: new nodes, moved ones, frames that now
  /// share a map. Sends a round of poses even where nothing changed but the revision.
  void publish(const PoseGraph& map);
  /// The names of the maps that trajectories were published in.
  [[nodiscard]] std::map<OdometryFrame, std::string> map_of_frames() const;

 private:
  // Nodes of one frame and one kind (poses or landmarks), in node order.
  struct Trajectory {
    std::vector<std::pair<std::uint64_t, NodeIndex>> nodes;  ///< (index, place in the map)
    std::string map;
    std::set<std::uint32_t> dirty;           ///< chunks
    std::optional<Correction> correction{};  ///< as published last
  };

  void add_new_nodes(const PoseGraph& map);
  void mark_moved(const PoseGraph& map);
  std::vector<Correction> correct_odometry(const PoseGraph& map);
  void name_maps(const PoseGraph& map);
  template <class Chunk, class Append>
  static std::vector<Chunk> take_changed(std::map<OdometryFrame, Trajectory>& all,
                                         const PoseGraph& map, Append append);
  [[nodiscard]] std::vector<PoseChunk> pose_chunks(const PoseGraph& map);
  [[nodiscard]] std::vector<LandmarkChunk> landmark_chunks(const PoseGraph& map);
  Trajectory& trajectory_of(const StoredNode& node);

  Transport& transport_;
  Jumps jumps_;
  std::map<OdometryFrame, Trajectory> poses_, landmarks_;
  ChunkedVector<Estimate> published_;  ///< by node
  std::size_t factors_seen_ = 0;
  std::vector<std::size_t> between_frames_;        ///< places of factors that tie two frames
  std::map<OdometryFrame, OdometryFrame> joined_;  ///< union-find over frames
  OdometryFrame root_of(const OdometryFrame& frame);
};

}  // namespace cairn
