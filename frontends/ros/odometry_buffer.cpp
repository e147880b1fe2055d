// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/ros/odometry_buffer.hpp"

#include <algorithm>

#include "frontends/host/epoch_watch.hpp"

namespace cairn {
namespace {

auto first_from(const std::deque<StampedPose>& poses, std::int64_t stamp_ns) {
  return std::lower_bound(
      poses.begin(), poses.end(), stamp_ns,
      [](const StampedPose& pose, std::int64_t stamp) { return pose.stamp_ns < stamp; });
}

}  // namespace

void OdometryBuffer::add(const StampedPose& pose) {
  if (!poses_.empty() && pose.stamp_ns < poses_.back().stamp_ns - EpochWatch::kMostBackNs)
    poses_.clear();
  const auto at = poses_.begin() + (first_from(poses_, pose.stamp_ns) - poses_.cbegin());
  if (at != poses_.end() && at->stamp_ns == pose.stamp_ns)
    *at = pose;
  else
    poses_.insert(at, pose);
  while (poses_.size() > kMost || poses_.front().stamp_ns < poses_.back().stamp_ns - kKeptNs)
    poses_.pop_front();
}

bool OdometryBuffer::reaches(std::int64_t stamp_ns) const {
  return !poses_.empty() && poses_.back().stamp_ns >= stamp_ns;
}

std::optional<std::int64_t> OdometryBuffer::newest_ns() const {
  if (poses_.empty()) return std::nullopt;
  return poses_.back().stamp_ns;
}

// Stamps are nanoseconds since 1970 and not negative: differences fit into 64 bits.
std::optional<Se2> OdometryBuffer::at(std::int64_t stamp_ns) const {
  const auto behind = first_from(poses_, stamp_ns);
  if (behind != poses_.end() && behind->stamp_ns == stamp_ns) return behind->T_odom_base;
  if (behind == poses_.begin()) return std::nullopt;
  const StampedPose& before = *std::prev(behind);
  if (behind != poses_.end() && behind->stamp_ns - before.stamp_ns <= kMostApartNs) {
    const double share = static_cast<double>(stamp_ns - before.stamp_ns) /
                         static_cast<double>(behind->stamp_ns - before.stamp_ns);
    const Se2::Tangent way = (before.T_odom_base.inverse() * behind->T_odom_base).log();
    return before.T_odom_base.retract(share * way);
  }
  if (stamp_ns - before.stamp_ns > kMostOldNs) return std::nullopt;
  return before.T_odom_base;
}

}  // namespace cairn
