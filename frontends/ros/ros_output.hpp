// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <optional>
#include <vector>

#include "frontends/host/host_observer.hpp"
#include "frontends/ros/live_trajectory.hpp"
#include "frontends/ros/ros_settings.hpp"
#include "idl/dds/ros_topics.hpp"

namespace cairn {

/// Publishes where the robot is in the map: map -> odom with each scan that has odometry, and the
/// whole trajectory at most once a second. One thread; never waits for a subscriber.
class RosOutput final : public HostObserver {
 public:
  /// `trouble` lives longer than the output.
  static Result<RosOutput> make(const dds::Participant& participant, const RosSettings& settings,
                                const dds::TroubleHandler* trouble);

  /// Where the laser, which is the body of poses in the map, sits on the robot.
  void set_T_base_laser(const Se2& T_base_laser) { T_base_laser_ = T_base_laser; }

  /// Also to be called while no scans come: what they left may be due.
  void publish_trajectory_when_due();

  void on_epoch(const OdometryFrame& frame) override;
  void on_keyframe(const Transaction& keyframe) override;
  void on_snapshot(const MapSnapshot& snapshot) override;
  void on_localized(const SensorFrame& frame, const LocalizedFrame& where) override;

 private:
  explicit RosOutput(const RosSettings& settings, const dds::TroubleHandler* trouble)
      : settings_(settings), trouble_(trouble) {}
  void publish_transform();
  void check(dds_return_t written, const std::string& topic) const;

  RosSettings settings_;
  const dds::TroubleHandler* trouble_;
  std::optional<dds::Writer<ros::TFMessage>> tf_;
  std::optional<dds::Writer<ros::Path>> path_;
  LiveTrajectory trajectory_;
  Se2 T_base_laser_;
  struct Placed {
    std::int64_t stamp_ns;
    Se2 T_odom_laser;  ///< by the robot's odometry
    LocalizedFrame where;
  };
  std::optional<Placed> newest_;  ///< frame that has odometry
  bool moved_ = false;            ///< since the trajectory was published
  std::chrono::steady_clock::time_point published_{};
};

}  // namespace cairn
