// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "frontends/matching/point_to_line.hpp"

namespace cairn {

struct LaserTrackerOptions {
  double keyframe_distance_m = 0.3, keyframe_angle_rad = 0.35;
  std::size_t submap_keyframes = 12;
  PointToLineOptions matching{};
  ScanPointOptions points{};
  /// Of the prediction by odometry: per metre, per radian, and at least.
  double odometry_m = 0.1, odometry_rad = 0.1, least_m = 0.01, least_rad = 0.01;
};

struct TrackedScan {
  Se2 T_odom_laser;      ///< in the tracker's own odometry frame
  std::size_t keyframe;  ///< the newest one, maybe this scan
  bool is_keyframe = false;
  PointToLineMatch match;
};

/// Follows one laser: each scan is matched with the last keyframes' points. One thread.
class LaserTracker {
 public:
  explicit LaserTracker(const LaserTrackerOptions& options = {}) : options_(options) {}

  TrackedScan track(const LaserScan& scan);

  struct Keyframe {
    std::int64_t stamp_ns;
    Se2 T_odom_laser;
    std::vector<SurfacePoint> points;  ///< in the laser's frame
    Eigen::Matrix3d information;       ///< of the pose relative to the keyframe before
  };
  [[nodiscard]] const std::deque<Keyframe>& keyframes() const { return keyframes_; }

 private:
  void add_keyframe(const LaserScan& scan, std::vector<SurfacePoint> points, const Se2& T,
                    const Eigen::Matrix3d& information);

  LaserTrackerOptions options_;
  std::deque<Keyframe> keyframes_;  ///< references stay valid
  std::optional<PointMap> submap_;
  std::optional<Se2> wheel_;  ///< at the last scan
  Se2 pose_;
};

}  // namespace cairn
