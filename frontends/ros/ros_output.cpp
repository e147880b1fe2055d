// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/ros/ros_output.hpp"

#include <utility>

namespace cairn {
namespace {

// Generated structs do not change the text that they borrow.
char* borrow(const std::string& text) { return const_cast<char*>(text.c_str()); }

}  // namespace

Result<RosOutput> RosOutput::make(const dds::Participant& participant, const RosSettings& settings,
                                  const dds::TroubleHandler* trouble) {
  RosOutput output(settings, trouble);
  if (!settings.tf.empty()) {
    auto writer = dds::Writer<ros::TFMessage>::make(
        participant, ros::describe<ros::TFMessage>(settings.tf, dds::Traffic::kTransforms),
        trouble);
    if (!writer) return writer.error();
    output.tf_.emplace(std::move(*writer));
  }
  if (!settings.trajectory.empty()) {
    auto writer = dds::Writer<ros::Path>::make(
        participant, ros::describe<ros::Path>(settings.trajectory, dds::Traffic::kLatest), trouble);
    if (!writer) return writer.error();
    output.path_.emplace(std::move(*writer));
  }
  return output;
}

void RosOutput::on_epoch(const OdometryFrame& frame) {
  trajectory_ = LiveTrajectory(frame);
  newest_.reset();
}

void RosOutput::on_keyframe(const Transaction& keyframe) {
  trajectory_.add(keyframe);
  moved_ = true;
}

void RosOutput::on_snapshot(const MapSnapshot& snapshot) {
  if (!trajectory_.update(snapshot)) return;
  moved_ = true;
  publish_transform();
  publish_trajectory_when_due();
}

void RosOutput::on_localized(const SensorFrame& frame, const LocalizedFrame& where) {
  const auto& scan = std::get<LaserScan>(frame);
  newest_.reset();
  if (scan.T_odom_laser) newest_ = Placed{scan.stamp_ns, *scan.T_odom_laser, where};
  publish_transform();
  publish_trajectory_when_due();
}

// What makes odometry and map agree about the newest scan.
void RosOutput::publish_transform() {
  if (!tf_ || !newest_) return;
  const auto T_map_laser = trajectory_.T_map_body(newest_->where);
  if (!T_map_laser) return;
  const ros::Pose pose = ros::to_pose(*T_map_laser * newest_->T_odom_laser.inverse());
  geometry_msgs_msg_dds__TransformStamped_ transform{};
  transform.header.stamp =
      ros::to_time(newest_->stamp_ns + std::chrono::nanoseconds(settings_.tf_ahead).count());
  transform.header.frame_id = borrow(settings_.map_frame);
  transform.child_frame_id = borrow(settings_.odom_frame);
  transform.transform.translation = {pose.position.x, pose.position.y, pose.position.z};
  transform.transform.rotation = pose.orientation;
  ros::TFMessage message{};
  message.transforms._length = message.transforms._maximum = 1;
  message.transforms._buffer = &transform;
  check(tf_->write(message), settings_.tf);
}

void RosOutput::publish_trajectory_when_due() {
  const auto now = std::chrono::steady_clock::now();
  if (!path_ || !moved_ || now - published_ < std::chrono::seconds(1)) return;
  const Se2 T_laser_base = T_base_laser_.inverse();
  std::vector<geometry_msgs_msg_dds__PoseStamped_> poses;
  poses.reserve(trajectory_.keyframes().size());
  for (const auto& [index, keyframe] : trajectory_.keyframes())
    poses.push_back({{ros::to_time(keyframe.stamp_ns), borrow(settings_.map_frame)},
                     ros::to_pose(trajectory_.T_map_body(keyframe) * T_laser_base)});
  if (poses.empty()) return;
  ros::Path path{};
  path.header = poses.back().header;
  path.poses._length = path.poses._maximum = static_cast<std::uint32_t>(poses.size());
  path.poses._buffer = poses.data();
  check(path_->write(path), settings_.trajectory);
  published_ = now;
  moved_ = false;
}

void RosOutput::check(dds_return_t written, const std::string& topic) const {
  if (written < 0) (*trouble_)(dds::to_error(written, "cannot write " + topic));
}

}  // namespace cairn
