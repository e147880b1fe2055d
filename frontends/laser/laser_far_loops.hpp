// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "frontends/laser/drift_bound.hpp"
#include "frontends/laser/laser_loop_closer.hpp"
#include "frontends/laser/loop_stories.hpp"
#include "frontends/place_recognition/place_descriptor.hpp"

namespace cairn {

struct LaserFarOptions {
  LaserLoopOptions search{
      .most_candidates = 3, .window = {1.5, 1.5, 0.5}, .least_score = 0.55, .least_inliers = 0.7};
  LoopStoryOptions stories{.least_agreeing = 5, .least_way_m = 2.0};
  float least_similarity = 0.8f;
  double most_m = 10.0, most_rad = 3.15;  ///< of a window
  std::size_t described = 10;  ///< keyframes before one that make the look of its place, and it
};

/// Loops of one laser's own way where poses may be far off: places that look alike anywhere within
/// what the constraints leave open, searched over all of that, and kept until some agree.
class LaserFarLoops {
 public:
  explicit LaserFarLoops(const LaserFarOptions& options = {})
      : options_(options), stories_(options.stories) {}

  /// The newest of `keyframes`, by its motion since the one before it, and since the one that the
  /// robot was at then if it is another.
  void add_keyframe(const std::vector<LoopKeyframe>& keyframes, const Se2& T_before_this,
                    const Eigen::Matrix3d& information, const std::optional<LaserLoop>& left);
  /// Of all keyframes, seen from the newest.
  [[nodiscard]] std::span<const PoseSigmas> sigmas() const { return sigmas_; }
  void add_loops(const std::vector<LaserLoop>& loops);
  [[nodiscard]] const DriftBound& drift() const { return drift_; }

  /// From the newest of `keyframes` to older ones that are not looked for nearby; and what now
  /// agrees with it.
  std::vector<LaserLoop> find(const std::vector<LoopKeyframe>& keyframes,
                              const LaserLoopOptions& nearby);

 private:
  struct Candidate {
    std::size_t at;
    SearchWindow window;
  };
  [[nodiscard]] std::vector<Candidate> candidates(const std::vector<LoopKeyframe>& keyframes,
                                                  const LaserLoopOptions& nearby) const;

  LaserFarOptions options_;
  DriftBound drift_;
  std::vector<PoseSigmas> sigmas_;
  std::vector<PlaceDescriptor> looks_;
  LoopStories stories_;
};

}  // namespace cairn
