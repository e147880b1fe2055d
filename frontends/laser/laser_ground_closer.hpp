// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "frontends/api/frontend.hpp"
#include "frontends/laser/laser_loop_closer.hpp"
#include "frontends/laser/loop_stories.hpp"
#include "frontends/place_recognition/place_descriptor.hpp"

namespace cairn {

struct LaserGroundOptions {
  LaserLoopOptions loops{};  ///< within a map: candidates are near by pose
  /// Between maps that nothing ties yet: candidates look alike, and are searched all around.
  LaserLoopOptions anywhere{
      .most_candidates = 3, .window = {2.5, 2.5, 3.15}, .least_score = 0.55, .least_inliers = 0.7};
  float least_similarity = 0.8f;
  LoopStoryOptions stories{};
  /// Of what one robot saw as surfaces, where the other says something: seen through by it.
  double most_seen_through = 0.12;
  std::size_t described = 10;  ///< keyframes before one that make the look of its place, and it
};

/// Loops among the laser keyframes of all robots, as a daemon tells of them: on the ground, where
/// robots see each other's ways. Loops between maps that nothing ties come from looks alone, and
/// places look alike: they are kept until enough of them tell one story.
class LaserGroundCloser final : public Frontend {
 public:
  explicit LaserGroundCloser(const LaserGroundOptions& options = {}) : options_(options) {}

  Result<void> start(FrontendContext& context) override;
  /// kUsage: it has no eyes of its own.
  Result<void> process(const SensorFrame& frame) override;
  void on_snapshot(const MapSnapshot& snapshot) override;
  Result<void> on_keyframe(const RobotKeyframe& keyframe) override;
  Result<void> stop() override { return {}; }

 private:
  struct Stored {
    std::vector<SurfacePoint> points;  ///< in the body's frame
    PlaceDescriptor look;
    std::vector<float> ranges_m;        ///< of the nearest point, by bearing; 0: none
    Eigen::Matrix3d match_information;  ///< as of LoopKeyframe
  };
  struct Track {
    std::string map;
    std::map<std::uint64_t, Se2> poses;         ///< T_map_body, by index
    std::map<std::uint64_t, Stored> keyframes;  ///< by index; each has a pose
  };
  /// The keyframes of a track, by place.
  struct View {
    std::vector<std::uint64_t> indices;
    std::vector<LoopKeyframe> keyframes;
  };

  [[nodiscard]] static View view(const Track& track);
  [[nodiscard]] Stored store(const Track& track, const Se2& T_map_body,
                             std::vector<SurfacePoint> points) const;
  Result<void> close_loops(const OdometryFrame& frame, std::uint64_t index);
  [[nodiscard]] std::optional<SubmapMatch> match_anywhere(const Track& track, const View& view,
                                                          const Stored& newest) const;
  void hear(const Sighting& sighting, Transaction& transaction);
  [[nodiscard]] Se2 pose_of(const NodeId& node) const;
  [[nodiscard]] LoopStories::Map map() const;
  [[nodiscard]] bool is_seen_through(const Sighting& newest) const;

  LaserGroundOptions options_;
  FrontendContext* context_ = nullptr;
  std::map<OdometryFrame, Track> tracks_;
  std::map<std::pair<OdometryFrame, OdometryFrame>, LoopStories> stories_;
};

}  // namespace cairn
