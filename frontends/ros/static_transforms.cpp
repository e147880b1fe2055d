// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/ros/static_transforms.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace cairn {
namespace {

constexpr double kFarthestM = 1000.0;
constexpr int kDeepest = 100;  // a chain that is longer goes in circles

// Old robots write "/laser".
std::string frame_of(const char* text) {
  std::string_view frame = text == nullptr ? "" : text;
  if (frame.starts_with('/')) frame.remove_prefix(1);
  return std::string(frame);
}

std::optional<Se3> to_se3(const geometry_msgs_msg_dds__Transform_& transform) {
  const auto& [x, y, z] = transform.translation;
  const Eigen::Vector3d translation(x, y, z);
  const auto& r = transform.rotation;
  const Eigen::Quaterniond rotation(r.w, r.x, r.y, r.z);
  if (!(translation.norm() <= kFarthestM) || !(std::abs(rotation.norm() - 1.0) <= 0.1))
    return std::nullopt;  // NaN is neither
  return Se3(So3(rotation.normalized()), translation);
}

}  // namespace

void StaticTransforms::add(const ros::TFMessage& message) {
  for (std::uint32_t i = 0; i < message.transforms._length; ++i) {
    const auto& told = message.transforms._buffer[i];
    std::string parent = frame_of(told.header.frame_id), child = frame_of(told.child_frame_id);
    const auto T_parent_child = to_se3(told.transform);
    const bool has_room = links_.size() < kMost || links_.contains(child);
    if (T_parent_child && has_room && parent != child)
      links_.insert_or_assign(std::move(child), Link{std::move(parent), *T_parent_child});
  }
}

StaticTransforms::Root StaticTransforms::root_of(std::string frame) const {
  Root root{std::move(frame), Se3()};
  for (int depth = 0; depth < kDeepest; ++depth) {
    const auto link = links_.find(root.frame);
    if (link == links_.end()) break;
    root.T_root_frame = link->second.T_parent_child * root.T_root_frame;
    root.frame = link->second.parent;
  }
  return root;
}

std::optional<Se3> StaticTransforms::T_a_b(const std::string& a, const std::string& b) const {
  const Root root_a = root_of(frame_of(a.c_str())), root_b = root_of(frame_of(b.c_str()));
  if (root_a.frame != root_b.frame || links_.contains(root_a.frame)) return std::nullopt;
  return root_a.T_root_frame.inverse() * root_b.T_root_frame;
}

LaserMount to_mount(const Se3& T_base_laser) {
  const Eigen::Matrix3d R = T_base_laser.rotation().matrix();
  const Eigen::Vector3d& t = T_base_laser.translation();
  LaserMount mount;
  mount.T_base_laser = Se2(t.x(), t.y(), std::atan2(R(1, 0), R(0, 0)));
  mount.upside_down = R(2, 2) < 0.0;
  mount.tilt_rad = std::acos(std::min(1.0, std::abs(R(2, 2))));
  return mount;
}

void turn_upright(LaserScan& scan) {
  const double last =
      scan.first_angle_rad + static_cast<double>(scan.ranges_m.size() - 1) * scan.angle_step_rad;
  scan.first_angle_rad = -last;
  std::reverse(scan.ranges_m.begin(), scan.ranges_m.end());
}

}  // namespace cairn
