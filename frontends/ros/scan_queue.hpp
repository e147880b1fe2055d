// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>

#include "frontends/api/laser_scan.hpp"
#include "frontends/ros/odometry_buffer.hpp"

namespace cairn {

/// Scans in the order of their arrival, each with the odometry of its stamp. Bounded: a laser does
/// not wait, so where the front-end is behind, the oldest scan that waits is dropped and counted.
/// Any thread.
class ScanQueue {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kMost = 20;  ///< half a second to two seconds of a laser
  /// A scan waits so long for odometry that is not older than it.
  static constexpr std::chrono::milliseconds kPatience{200};

  struct Counts {
    std::uint64_t arrived = 0, dropped = 0, without_odometry = 0;
  };
  struct Entry {
    LaserScan scan;
    Clock::time_point arrived;
  };

  explicit ScanQueue(bool has_odometry) : has_odometry_(has_odometry) {}

  void set_T_base_laser(const Se2& T_base_laser);
  [[nodiscard]] Se2 T_base_laser() const;

  /// False where the oldest one had to go for it.
  bool push(LaserScan scan, Clock::time_point now = Clock::now());
  void push(const StampedPose& odometry);
  /// Waits until then; nothing: no scan is ready.
  std::optional<LaserScan> pop(Clock::time_point until);
  [[nodiscard]] Counts counts() const;
  /// Of odometry.
  [[nodiscard]] std::optional<std::int64_t> newest_odometry_ns() const;

 private:
  [[nodiscard]] bool is_ready(Clock::time_point now) const;
  LaserScan take();

  const bool has_odometry_;
  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  std::deque<Entry> waiting_;
  OdometryBuffer odometry_;
  Se2 T_base_laser_;
  Counts counts_;
};

}  // namespace cairn
