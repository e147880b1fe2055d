// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "frontends/laser/known_places.hpp"
#include "frontends/laser/laser_keyframe.hpp"
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
  /// Where the robot was before, no keyframes are made. Somebody must close loops then.
  bool know_places = true;
  KnownPlaceOptions places{};
};

struct TrackedScan {
  Se2 T_odom_laser;      ///< in the tracker's own odometry frame
  std::size_t keyframe;  ///< the newest one, maybe this scan; or that of a known place
  Se2 T_keyframe_laser{};
  bool is_keyframe = false;
  PointToLineMatch match;
};

/// Follows one laser: each scan is matched with the last keyframes' points. One thread.
class LaserTracker {
 public:
  explicit LaserTracker(const LaserTrackerOptions& options = {})
      : options_(options), odometry_(options.wheels), places_(options.places) {}

  TrackedScan track(const LaserScan& scan);

  [[nodiscard]] const std::deque<LaserKeyframe>& keyframes() const { return keyframes_; }

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
  void stand_at(const KnownPlace& place);
  void begin_stretch();
  [[nodiscard]] LaserLoop way_here(const PointToLineMatch& match) const;
  void renew_submap();

  LaserTrackerOptions options_;
  std::deque<LaserKeyframe> keyframes_;  ///< references stay valid
  /// What scans are put to: the newest keyframe, or that of the known place.
  struct Reference {
    std::size_t keyframe = 0;
    Se2 T_odom_keyframe{};
    bool is_known_place = false;
  };
  Reference at_;
  Se2 due_from_;                       ///< where a keyframe was made or was not needed last
  std::vector<SurfacePoint> known_;    ///< around the last known place, in the odometry frame
  std::size_t first_after_known_ = 0;  ///< keyframe
  OdometryNoise odometry_;
  KnownPlaces places_;
  std::optional<PointMap> submap_;
  std::optional<LikelihoodGrid> submap_grid_;  ///< of its points, where it was searched
  std::optional<Se2> wheel_;                   ///< at the last scan
  Se2 wheel_at_;                               ///< the pose when it came to be so
  Se2 pose_;
  Se2 motion_;         ///< of the last scan against the one before
  bool sees_ = false;  ///< the last scan left no direction free
  Se2 since_;          ///< due_from_, by prediction alone
  double way_since_ = 0.0;
  bool guessed_since_ = false;
  double blind_way_ = 0.0;   ///< since a known place left no direction free
  double detour_way_ = 0.0;  ///< at known places, since the newest keyframe
};

}  // namespace cairn
