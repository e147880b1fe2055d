// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/ros/scan_queue.hpp"

#include <algorithm>
#include <utility>

namespace cairn {

void ScanQueue::set_T_base_laser(const Se2& T_base_laser) {
  const std::lock_guard lock(mutex_);
  T_base_laser_ = T_base_laser;
}

Se2 ScanQueue::T_base_laser() const {
  const std::lock_guard lock(mutex_);
  return T_base_laser_;
}

bool ScanQueue::push(LaserScan scan, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  ++counts_.arrived;
  waiting_.push_back({std::move(scan), now});
  const bool full = waiting_.size() > kMost;
  if (full) {
    waiting_.pop_front();
    ++counts_.dropped;
  }
  changed_.notify_one();
  return !full;
}

void ScanQueue::push(const StampedPose& odometry) {
  const std::lock_guard lock(mutex_);
  odometry_.add(odometry);
  changed_.notify_one();
}

bool ScanQueue::is_ready(Clock::time_point now) const {
  const Entry& oldest = waiting_.front();
  return !has_odometry_ || odometry_.reaches(oldest.scan.stamp_ns) ||
         now >= oldest.arrived + kPatience;
}

LaserScan ScanQueue::take() {
  LaserScan scan = std::move(waiting_.front().scan);
  waiting_.pop_front();
  if (!has_odometry_) return scan;
  if (const auto T_odom_base = odometry_.at(scan.stamp_ns))
    scan.T_odom_laser = *T_odom_base * T_base_laser_;
  else
    ++counts_.without_odometry;
  return scan;
}

std::optional<LaserScan> ScanQueue::pop(Clock::time_point until) {
  std::unique_lock lock(mutex_);
  while (true) {
    const auto now = Clock::now();
    if (!waiting_.empty() && is_ready(now)) return take();
    if (now >= until) return std::nullopt;
    changed_.wait_until(
        lock, waiting_.empty() ? until : std::min(until, waiting_.front().arrived + kPatience));
  }
}

ScanQueue::Counts ScanQueue::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

std::optional<std::int64_t> ScanQueue::newest_odometry_ns() const {
  const std::lock_guard lock(mutex_);
  return odometry_.newest_ns();
}

}  // namespace cairn
