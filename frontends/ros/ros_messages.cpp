// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/ros/ros_messages.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "cairn/maps/range_scan.hpp"

namespace cairn {
namespace {

constexpr double kFullTurn = 2.0 * std::numbers::pi;
constexpr double kLeastStepRad = 1e-6;
constexpr double kFarthestAngle = 4.0 * std::numbers::pi;
constexpr double kFarthestRangeM = 10'000.0;  // what a payload laser_scan/1 holds
constexpr double kFarthestM = 1e7;            // around the Earth's quarter
constexpr double kBeamsOff = 2.0;             // drivers count the last beam, or do not

Error bad(const std::string& message) { return {ErrorCode::kBadInput, message}; }

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

bool is_within(double value, double limit) { return std::abs(value) <= limit; }  // NaN is not

// The angles must be those of so many beams: a scan that contradicts itself would bend the map.
Result<void> check_angles(const ros::LaserScan& message) {
  const double step = message.angle_increment;
  const std::size_t beams = message.ranges._length;
  if (!is_within(step, kFullTurn) || std::abs(step) < kLeastStepRad)
    return bad("angle_increment is " + number(step) +
               " rad; expected the angle between two beams, at least 1e-6 rad");
  if (!is_within(message.angle_min, kFarthestAngle) ||
      !is_within(message.angle_max, kFarthestAngle))
    return bad("the angles go from " + number(message.angle_min) + " to " +
               number(message.angle_max) + " rad; expected at most two turns either way");
  const double last = message.angle_min + static_cast<double>(beams - 1) * step;
  if (std::abs(last - message.angle_max) > kBeamsOff * std::abs(step))
    return bad("angle_min " + number(message.angle_min) + ", angle_max " +
               number(message.angle_max) + " and angle_increment " + number(step) +
               " are not those of its " + std::to_string(beams) + " ranges");
  if (static_cast<double>(beams - 1) * std::abs(step) > kFullTurn + std::abs(step))
    return bad("its " + std::to_string(beams) + " beams go around more than once");
  return {};
}

Result<void> check(const ros::LaserScan& message) {
  if (message.ranges._length < 2 || message.ranges._length > kMaxBeams)
    return bad("it has " + std::to_string(message.ranges._length) + " ranges; expected 2 to " +
               std::to_string(kMaxBeams));
  if (!ros::stamp_ns(message.header.stamp))
    return bad("its stamp is " + std::to_string(message.header.stamp.sec) + " s and " +
               std::to_string(message.header.stamp.nanosec) +
               " ns; expected one since 1970 with less than 1e9 ns");
  if (!(message.range_max > 0.0F) || !is_within(message.range_max, kFarthestRangeM))
    return bad("range_max is " + number(message.range_max) +
               " m; expected how far the laser sees, above 0 and up to 10000 m");
  if (!(message.range_min >= 0.0F && message.range_min < message.range_max))
    return bad("range_min is " + number(message.range_min) + " m; expected 0 up to range_max, " +
               number(message.range_max) + " m");
  return check_angles(message);
}

// REP 117: inf means no echo, -inf too near, NaN no measurement.
float to_reading(float range, const ros::LaserScan& message) {
  if (std::isnan(range) || range < message.range_min || range <= 0.0F) return 0.0F;
  return std::min(range, message.range_max);
}

}  // namespace

Result<LaserScan> to_laser_scan(const ros::LaserScan& message) {
  if (auto sound = check(message); !sound) return sound.error();
  LaserScan scan;
  scan.stamp_ns = *ros::stamp_ns(message.header.stamp);
  scan.first_angle_rad = message.angle_min;
  scan.angle_step_rad = message.angle_increment;
  scan.max_range_m = message.range_max;
  scan.ranges_m.reserve(message.ranges._length);
  for (std::uint32_t i = 0; i < message.ranges._length; ++i)
    scan.ranges_m.push_back(to_reading(message.ranges._buffer[i], message));
  if (scan.angle_step_rad < 0.0) {  // a laser that turns clockwise
    scan.first_angle_rad += static_cast<double>(message.ranges._length - 1) * scan.angle_step_rad;
    scan.angle_step_rad = -scan.angle_step_rad;
    std::reverse(scan.ranges_m.begin(), scan.ranges_m.end());
  }
  return scan;
}

Result<StampedPose> to_stamped_pose(const ros::Odometry& message) {
  const auto stamp = ros::stamp_ns(message.header.stamp);
  if (!stamp)
    return bad("its stamp is " + std::to_string(message.header.stamp.sec) + " s and " +
               std::to_string(message.header.stamp.nanosec) +
               " ns; expected one since 1970 with less than 1e9 ns");
  const auto& [x, y, z] = message.pose.pose.position;
  if (!is_within(x, kFarthestM) || !is_within(y, kFarthestM) || !std::isfinite(z))
    return bad("its position is " + number(x) + " " + number(y) + " " + number(z) +
               "; expected finite metres, at most 1e7");
  const auto& q = message.pose.pose.orientation;
  const double norm = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (!is_within(norm - 1.0, 0.1))
    return bad("its orientation has the norm " + number(norm) + "; expected a unit quaternion");
  const double yaw =
      std::atan2(2.0 * (q.w * q.z + q.x * q.y), q.w * q.w + q.x * q.x - q.y * q.y - q.z * q.z);
  return StampedPose{*stamp, Se2(x, y, yaw)};
}

}  // namespace cairn
