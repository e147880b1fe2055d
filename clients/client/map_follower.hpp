// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "clients/client/map_copy.hpp"
#include "idl/link.hpp"

namespace cairn {

/// Keeps a MapCopy up to date: asks, on a thread of its own, for what the index names and is not
/// here, one request at a time. Any thread may call it.
class MapFollower {
 public:
  struct Options {
    std::uint32_t budget_bytes = 256u << 10;   ///< of one answer
    std::chrono::milliseconds pause{100};      ///< from an answer to the next request
    std::chrono::milliseconds patience{2000};  ///< for an answer; doubled each time, up to 16 times
    std::chrono::milliseconds quiet{5000};  ///< so long after the index came it is taken as whole
  };
  struct Calls {
    std::function<void()> prune_now;  ///< the index is whole: prune() is to be called
    std::function<void(Error)> tell;
  };

  /// `link` and what `calls` use live until stop().
  MapFollower(Link& link, std::uint64_t client, Options options, Calls calls)
      : link_(link), client_(client), options_(options), calls_(std::move(calls)) {}
  ~MapFollower() { stop(); }

  void start();
  void stop();
  MapChange take(const TileBlock& block);
  /// kBadInput where the daemon could not read the request, or this the answer.
  Result<MapChange> take(const TileAnswer& answer);
  std::vector<MapChange> prune();
  /// What is nearest to here comes first, m in the map.
  void look_from(double x_m, double y_m);
  [[nodiscard]] std::vector<MapView> views() const;

 private:
  using Clock = std::chrono::steady_clock;
  using Lock = std::unique_lock<std::mutex>;

  void run();
  void ask(Lock& lock);

  Link& link_;
  std::uint64_t client_;
  Options options_;
  Calls calls_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  MapCopy copy_;
  double x_m_ = 0.0, y_m_ = 0.0;
  bool news_ = false;        // something may be missing
  std::uint64_t asked_ = 0;  // the number of the last request
  std::int64_t asked_run_ = 0;
  int unanswered_ = 0;          // requests since the last answer
  Clock::time_point ask_at_{};  // not before
  std::optional<Clock::time_point> prune_at_{};
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace cairn
