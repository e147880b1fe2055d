// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>

#include "server/map_observer.hpp"
#include "server/published_tiles.hpp"
#include "server/scan_book.hpp"
#include "server/transport.hpp"

namespace cairn {

/// What a map is rendered from: cheap to take, and it stays as it is.
struct MapBasis {
  PoseGraph graph;
  std::map<OdometryFrame, std::string> map_of;  ///< frames with the same map are comparable
  bool settled = false;  ///< nothing is to be solved: the exact poses are worth the work
};

/// Occupancy maps of the live estimate, kept up to date, and tiles of them for clients. A thread of
/// lower priority renders; it holds no lock meanwhile and nobody waits for it. When there is news
/// it asks for a snapshot, renders all of it, and publishes what has changed at once: maps are
/// never half way.
class MapService {
 public:
  struct Options {
    bool enabled = true;
    double resolution_m = 0.05;  ///< side of a cell
    /// From the end of one rendering to the next.
    std::chrono::milliseconds render_every{500};
    /// Counts of cells take 32 kB a tile; more tiles than this allows are not rendered.
    std::size_t most_bytes = 1u << 30;
    MapObserver on_map{};
  };
  /// Called from the service's thread; they must not wait for it.
  struct Calls {
    std::function<void()> ask_for_snapshot;  ///< show() is to come, when that suits
    /// It was read. Who writes to the head lets it go: nobody else knows when what was read here
    /// may be written to.
    std::function<void(PoseGraph)> give_back;
    std::function<void(Severity, const std::string& text)> tell;
  };
  struct Facts {
    std::size_t maps = 0, tiles = 0, tile_bytes = 0;
    std::size_t scans = 0;    ///< rendered
    std::size_t missing = 0;  ///< keyframes name them, and they have not come
    std::uint64_t tile_revision = 0;
    EstimateRevisions estimate{};             ///< that is rendered and published
    double render_s = 0.0;                    ///< how long that took
    std::uint64_t answers = 0, refusals = 0;  ///< to requests for tiles
    bool rendering = false, full = false;
  };

  /// All outlive the service.
  MapService(const Journal& journal, Transport& transport, Options options, Calls calls);
  ~MapService() { stop(); }
  MapService(const MapService&) = delete;
  MapService& operator=(const MapService&) = delete;

  /// `run` names this run of the daemon.
  void start(std::int64_t run);
  /// A rendering is left after the scan that it is at.
  void stop();

  /// From any thread; none of them waits.
  void hear_of_news();  ///< the estimate has changed
  void hear_of_payload();
  void show(MapBasis snapshot);
  void take(TileRequest request);
  [[nodiscard]] Facts facts() const;
  [[nodiscard]] bool enabled() const { return options_.enabled; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Layer {
    explicit Layer(double resolution_m) : map(resolution_m) {}
    LaserMap map;
    std::set<TileIndex> changed{};  ///< since it was published
  };

  void run();
  [[nodiscard]] bool may_ask() const;  // under mutex_
  void render(MapBasis snapshot);
  bool render_layers(const ScanBook::Placed& placed, Precision precision);
  [[nodiscard]] std::size_t tiles_of_others(const std::string& map) const;
  void publish(const EstimateRevisions& estimate);
  void answer_one();

  Transport& transport_;
  Options options_;
  Calls calls_;

  // Of the thread.
  ScanBook scans_;
  PublishedTiles published_{0, 0.05};
  std::map<std::string, Layer> layers_;
  bool told_full_ = false;

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable wake_;
  std::optional<MapBasis> snapshot_;
  std::deque<TileRequest> requests_;  ///< one of each client at most
  bool news_ = false, asked_ = false;
  std::uint64_t payloads_ = 0, payloads_seen_ = 0;
  Clock::time_point next_render_{};
  Facts facts_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace cairn
