// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "frontends/laser/laser_far_loops.hpp"
#include "frontends/laser/laser_keyframe.hpp"
#include "frontends/laser/laser_loop_closer.hpp"

namespace cairn {

struct KnownPlaceOptions {
  /// While the robot is not known to be where it was before: matched as for loops.
  LaserLoopOptions search{.least_inliers = 0.7};
  LaserFarOptions far{.search{
      .most_candidates = 1, .window = {1.5, 1.5, 0.5}, .least_score = 0.55, .least_inliers = 0.7}};
  /// So many matches in a row that agree with where the one before puts the robot, each as sure as
  /// this, make it known.
  std::size_t least_agreeing = 10;
  double agree_m = 0.15, agree_rad = 0.05, least_sure_m = 0.1;
  /// Those that drift may have moved no further than this are not searched for.
  double most_beside_m = 0.08;
  /// A scan is known where so many of its points that have a line are on a surface.
  double least_known = 0.8;
  /// Covariance of the way from one to the next (m, rad): holds what no surface does.
  Eigen::Matrix3d told = Eigen::Vector3d(2.5e-3, 2.5e-3, 2.5e-3).asDiagonal();
  double near_m = 1.5, near_rad = 0.7;  ///< how far a keyframe is that may show the place
  std::size_t most_new = 12;            ///< keyframes since the last known place, then it is lost
};

/// A keyframe around which the surfaces of a scan are seen already.
struct KnownPlace {
  std::size_t keyframe;
  Se2 T_keyframe_laser;
};

/// Whether a robot is where it was before, so that its scans need no keyframes. Keyframes keep the
/// place where they were made, relative to those before, and places are where the surest path to
/// them leads: no map is optimized here, so that the same log gives the same keyframes. One thread.
class KnownPlaces {
 public:
  explicit KnownPlaces(const KnownPlaceOptions& options = {})
      : options_(options), loops_(options.far) {}

  /// The newest one. Its points must stay.
  void add_keyframe(const LaserKeyframe& keyframe);

  /// Asked where the robot has gone far enough for a keyframe: which one shows the scan already.
  std::optional<KnownPlace> find(const std::vector<SurfacePoint>& points, const Se2& T_odom_laser);
  /// That are to be seen from a keyframe, in its frame.
  [[nodiscard]] std::vector<SurfacePoint> surfaces(std::size_t keyframe) const;

 private:
  [[nodiscard]] bool is_known() const { return agreeing_ >= options_.least_agreeing; }
  void stand_at(std::size_t keyframe, const Se2& T_odom_keyframe);
  void look_around();
  std::optional<SubmapMatch> search(std::optional<std::size_t> nearest);
  [[nodiscard]] std::optional<SubmapMatch> match(std::size_t at,
                                                 const std::vector<SurfacePoint>& points,
                                                 const Se2& T_map_laser) const;
  /// Of those before `end`.
  [[nodiscard]] std::optional<std::size_t> nearest(const Se2& T_map_laser, std::size_t end) const;
  [[nodiscard]] bool is_sure(const SubmapMatch& match) const;

  KnownPlaceOptions options_;
  std::vector<LoopKeyframe> map_;  ///< seen from where the robot is
  std::vector<DriftBound::Seen> seen_;
  LaserFarLoops loops_;
  Se2 T_odom_map_, T_odom_newest_;
  std::size_t agreeing_ = 0;   ///< in a row
  std::size_t known_end_ = 0;  ///< keyframes from here on were made since the last known place
};

}  // namespace cairn
