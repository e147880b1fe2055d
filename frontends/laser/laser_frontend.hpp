// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "frontends/api/frontend.hpp"
#include "frontends/laser/blind_stretch.hpp"
#include "frontends/laser/laser_far_loops.hpp"
#include "frontends/laser/laser_loop_closer.hpp"
#include "frontends/laser/laser_tracker.hpp"

namespace cairn {

struct LaserOptions {
  LaserTrackerOptions tracker{};
  LaserLoopOptions loops{};
  LaserFarOptions far_loops{};
};

/// Scans to keyframes and loop closures.
class LaserFrontend final : public Frontend {
 public:
  explicit LaserFrontend(const LaserOptions& options = {})
      : options_(options), far_loops_(options.far_loops) {}

  Result<void> start(FrontendContext& context) override;
  Result<void> process(const SensorFrame& frame) override;
  void on_snapshot(const MapSnapshot& snapshot) override;
  Result<void> stop() override;

 private:
  Result<void> add_keyframe(const LaserScan& scan);
  Result<void> submit_keyframe(const LaserScan& scan, const Se2& T_before_newest);
  Result<void> close_loops(std::size_t keyframe);
  [[nodiscard]] Se2 continued(std::size_t keyframe) const;
  [[nodiscard]] NodeId node(std::size_t keyframe) const;
  void tell_missing_odometry(const LaserScan& scan);

  LaserOptions options_;
  std::optional<LaserTracker> tracker_;  ///< since start()
  LaserFarLoops far_loops_;
  BlindStretch blind_;
  bool told_missing_odometry_ = false;
  FrontendContext* context_ = nullptr;
  std::vector<LoopKeyframe> map_;  ///< by keyframe: optimized as far as is known, then by odometry
  std::optional<ContentHash>
      first_scan_;                    ///< named by the second keyframe: the first has no factor
  std::map<std::size_t, Se2> ahead_;  ///< told of keyframes that a run before this one has sent
  std::size_t optimized_ = 0;         ///< keyframes of which the daemon has told a pose
};

}  // namespace cairn
