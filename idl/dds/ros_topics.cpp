// SPDX-License-Identifier: BSD-3-Clause
#include "idl/dds/ros_topics.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string_view>

namespace cairn::ros {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::uint32_t kLastDomain = 230;
constexpr std::size_t kLongestTopic = 200;

}  // namespace

template <>
const dds_topic_descriptor_t* descriptor_of<LaserScan>() {
  return &sensor_msgs_msg_dds__LaserScan__desc;
}
template <>
const dds_topic_descriptor_t* descriptor_of<Odometry>() {
  return &nav_msgs_msg_dds__Odometry__desc;
}
template <>
const dds_topic_descriptor_t* descriptor_of<Path>() {
  return &nav_msgs_msg_dds__Path__desc;
}
template <>
const dds_topic_descriptor_t* descriptor_of<OccupancyGrid>() {
  return &nav_msgs_msg_dds__OccupancyGrid__desc;
}
template <>
const dds_topic_descriptor_t* descriptor_of<OccupancyGridUpdate>() {
  return &map_msgs_msg_dds__OccupancyGridUpdate__desc;
}
template <>
const dds_topic_descriptor_t* descriptor_of<TFMessage>() {
  return &tf2_msgs_msg_dds__TFMessage__desc;
}

Result<std::string> topic_name(const std::string& name) {
  const std::string_view bare =
      name.starts_with('/') ? std::string_view(name).substr(1) : std::string_view(name);
  const bool sound =
      !bare.empty() && bare.size() <= kLongestTopic && bare.back() != '/' && bare.front() != '/' &&
      bare.find("//") == std::string_view::npos &&
      std::all_of(bare.begin(), bare.end(), [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '/';
      });
  if (sound) return "rt/" + std::string(bare);
  return Error{ErrorCode::kUsage, "'" + name.substr(0, 60) +
                                      "' is no name of a ROS topic; expected one like /front/scan"};
}

Result<std::uint32_t> domain_of_environment() {
  const char* text = std::getenv("ROS_DOMAIN_ID");
  if (text == nullptr || *text == '\0') return std::uint32_t{0};
  std::uint32_t domain = 0;
  const std::string_view view(text);
  const auto [end, error] = std::from_chars(view.data(), view.data() + view.size(), domain);
  if (error == std::errc() && end == view.data() + view.size() && domain <= kLastDomain)
    return domain;
  return Error{ErrorCode::kUsage, "the environment's ROS_DOMAIN_ID is '" +
                                      std::string(view.substr(0, 40)) +
                                      "'; expected a number from 0 to 230"};
}

std::optional<std::int64_t> stamp_ns(const Time& time) {
  if (time.sec < 0 || time.nanosec >= kSecond) return std::nullopt;
  return time.sec * kSecond + time.nanosec;
}

Time to_time(std::int64_t stamp_ns) {
  const std::int64_t kept =
      std::clamp<std::int64_t>(stamp_ns, 0, kSecond * std::numeric_limits<std::int32_t>::max());
  return {static_cast<std::int32_t>(kept / kSecond), static_cast<std::uint32_t>(kept % kSecond)};
}

Quaternion to_quaternion(double yaw_rad) {
  return {0.0, 0.0, std::sin(0.5 * yaw_rad), std::cos(0.5 * yaw_rad)};
}

Pose to_pose(const Se2& T) { return {{T.x(), T.y(), 0.0}, to_quaternion(T.theta())}; }

}  // namespace cairn::ros
