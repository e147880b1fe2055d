// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "cairn/core/result.hpp"
#include "idl/dds/ros_topics.hpp"
#include "server/ros_grid.hpp"

namespace cairn {

struct RosMapOptions {
  std::string map{};  ///< topic, such as "/map"; empty: nothing is published
  std::string updates = "/map_updates";
  std::string frame = "map";
  std::uint32_t domain = 0;
  dds::Network network{};
  /// A map that has grown is published at most so often ...
  std::chrono::milliseconds whole_every{1000};
  /// ... changed tiles of one that has not so often ...
  std::chrono::milliseconds updates_every{200};
  /// ... and the whole of it, for those who come later, so often.
  std::chrono::milliseconds renew_every{5000};
  /// Another map takes the topic over when this one has not changed for so long.
  std::chrono::milliseconds silence{10'000};
};

/// Publishes one of the daemon's maps as ROS's OccupancyGrid (latest kept) and OccupancyGridUpdate,
/// from a thread of its own: the first one, until it is gone or still, then one that changes.
class RosMap {
 public:
  /// kUsage for names that ROS does not have, kUnreachable where the network cannot be used.
  /// `trouble` is called from any thread, until the end.
  static Result<std::unique_ptr<RosMap>> open(RosMapOptions options, dds::TroubleHandler trouble);
  ~RosMap();

  /// What changed in the map of this name; from any thread, waits for nobody.
  void take(const std::string& map, const std::map<TileIndex, MapTile>& changed,
            const std::vector<TileIndex>& gone, double resolution_m);

 private:
  using Clock = std::chrono::steady_clock;
  struct Map {
    RosGrid grid;
    Clock::time_point changed_at{};
  };

  RosMap(RosMapOptions options, dds::TroubleHandler trouble)
      : options_(std::move(options)), trouble_(std::move(trouble)) {}
  Result<void> start();
  void run();
  void choose(Clock::time_point now);
  void publish(Clock::time_point now, std::unique_lock<std::mutex>& lock);
  void write(const RosGrid::Image& image);
  void write(const RosGrid::Patch& patch);
  [[nodiscard]] ros::Header header() const;

  RosMapOptions options_;
  dds::TroubleHandler trouble_;
  std::string map_topic_, updates_topic_;
  std::optional<dds::Participant> participant_;
  std::optional<dds::Writer<ros::OccupancyGrid>> map_;
  std::optional<dds::Writer<ros::OccupancyGridUpdate>> updates_;

  // Of the thread.
  std::string current_;
  bool stale_ = false;  ///< late comers lack updates
  bool told_size_ = false;
  Clock::time_point whole_at_{}, updates_at_{};

  std::mutex mutex_;  // guards what follows
  std::condition_variable wake_;
  std::map<std::string, Map> maps_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace cairn
