// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "frontends/laser/odometry_noise.hpp"
#include "frontends/matching/correlative.hpp"
#include "frontends/matching/point_to_line.hpp"

namespace cairn {

/// Without odometry the motion from scan to scan is taken to be what it was before. Where surfaces
/// do not fit there, or where odometry says (it stops and jumps at times), the scan is searched for
/// around.
struct MotionGuessOptions {
  double least_m = 0.05, least_rad = 0.05;  ///< sigmas of the guess: at least, and of its size
  double share = 0.5;
  double least_inliers = 0.6;  ///< of the points that have a line; else it is searched for
  /// So many times the inliers elsewhere overrule odometry, where they are this share of the points
  /// that have a counterpart at all.
  double clearly = 1.1, clean = 0.95;
  SearchWindow window{0.6, 0.6, 0.6};
  double least_score = 0.4;
  std::int64_t most_lookups = 20'000'000;
  LikelihoodGrid::Options grid{};
  double way = 0.05;  ///< per scan (m or rad), beside its own: how far a guess goes, for its noise
};

struct LaserTrackerOptions {
  double keyframe_distance_m = 0.3, keyframe_angle_rad = 0.35;
  std::size_t submap_keyframes = 12;
  PointToLineOptions matching{};
  ScanPointOptions points{};
  /// Of the prediction by odometry: per metre, per radian, and at least.
  double odometry_m = 0.1, odometry_rad = 0.1, least_m = 0.01, least_rad = 0.01;
  OdometryNoise::Prior wheels{};  ///< of what holds directions that no surface does
  MotionGuessOptions guess{};     ///< where scans come without odometry
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
  explicit LaserTracker(const LaserTrackerOptions& options = {})
      : options_(options), odometry_(options.wheels) {}

  TrackedScan track(const LaserScan& scan);

  struct Keyframe {
    std::int64_t stamp_ns;
    Se2 T_odom_laser;
    std::vector<SurfacePoint> points;  ///< in the laser's frame
    Eigen::Matrix3d information;       ///< of the pose relative to the keyframe before
    Eigen::Matrix3d
        match_information;  ///< of the pose relative to the surfaces it was matched with
  };
  [[nodiscard]] const std::deque<Keyframe>& keyframes() const { return keyframes_; }

 private:
  struct Expected {
    Se2 step;                     ///< from the last scan to this one
    bool guessed = false;         ///< not by odometry
    bool late = false;            ///< odometry has not said yet
    Eigen::Matrix3d information;  ///< of the step (m, rad)
    double way = 0.0;             ///< that its noise grows with
  };
  Expected predict(const LaserScan& scan);
  [[nodiscard]] Expected guess_motion() const;
  [[nodiscard]] PointToLineMatch match(const std::vector<SurfacePoint>& points, Expected& expected);
  void try_around(const std::vector<SurfacePoint>& points, const Se2& T_odom_laser,
                  const std::function<void(const Se2&)>& try_from);
  Eigen::Matrix3d step_information(const PointToLineMatch& match);
  void add_keyframe(const LaserScan& scan, std::vector<SurfacePoint> points,
                    const PointToLineMatch& match);

  LaserTrackerOptions options_;
  std::deque<Keyframe> keyframes_;  ///< references stay valid
  std::optional<PointMap> submap_;
  std::optional<LikelihoodGrid> submap_grid_;  ///< of its points, where it was searched
  std::optional<Se2> wheel_;                   ///< at the last scan
  Se2 wheel_at_;                               ///< the pose when it came to be so
  Se2 pose_;
  Se2 motion_;         ///< of the last scan against the one before
  bool sees_ = false;  ///< the last scan left no direction free
  Se2 since_;          ///< the newest keyframe, by prediction alone
  double way_since_ = 0.0;
  bool guessed_since_ = false;
  OdometryNoise odometry_;
};

}  // namespace cairn
