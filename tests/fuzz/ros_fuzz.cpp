// SPDX-License-Identifier: BSD-3-Clause
// Numbers of ROS messages, in the order of their fields; the rest of the input is ranges. What is
// accepted is a scan that becomes points and a payload, or a pose in the plane.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "cairn/maps/range_scan.hpp"
#include "frontends/matching/scan_points.hpp"
#include "frontends/ros/ros_messages.hpp"

namespace {

// Zeros where the input ends.
class Input {
 public:
  Input(const unsigned char* data, std::size_t size) : data_(data), left_(size) {}
  template <class Number>
  void read(Number& number) {
    const std::size_t taken = std::min(sizeof number, left_);
    std::memcpy(&number, data_, taken);
    data_ += taken;
    left_ -= taken;
  }
  [[nodiscard]] std::size_t left() const { return left_; }

 private:
  const unsigned char* data_;
  std::size_t left_;
};

void require(bool condition) {
  if (!condition) std::abort();
}

void check_scan(Input in) {
  cairn::ros::LaserScan message{};
  in.read(message.header.stamp.sec);
  in.read(message.header.stamp.nanosec);
  for (float* field : {&message.angle_min, &message.angle_max, &message.angle_increment,
                       &message.range_min, &message.range_max})
    in.read(*field);
  std::vector<float> ranges(in.left() / sizeof(float));
  for (float& range : ranges) in.read(range);
  message.ranges._length = message.ranges._maximum = static_cast<std::uint32_t>(ranges.size());
  message.ranges._buffer = ranges.data();
  const auto scan = cairn::to_laser_scan(message);
  if (!scan) return require(!scan.error().message.empty());
  require(scan->stamp_ns >= 0 && scan->angle_step_rad > 0.0);
  require(scan->ranges_m.size() == ranges.size());
  for (const float range : scan->ranges_m) require(range >= 0.0F && range <= scan->max_range_m);
  for (const cairn::SurfacePoint& point : cairn::surface_points(*scan))
    require(point.position.allFinite() && point.normal.allFinite());
  require(cairn::encode({.first_angle_rad = scan->first_angle_rad,
                         .angle_step_rad = scan->angle_step_rad,
                         .max_range_m = scan->max_range_m,
                         .T_body_laser = cairn::Se2(),
                         .ranges_m = scan->ranges_m})
              .ok());
}

void check_odometry(Input in) {
  cairn::ros::Odometry message{};
  in.read(message.header.stamp.sec);
  in.read(message.header.stamp.nanosec);
  auto& [position, q] = message.pose.pose;
  for (double* field : {&position.x, &position.y, &position.z, &q.x, &q.y, &q.z, &q.w})
    in.read(*field);
  const auto pose = cairn::to_stamped_pose(message);
  if (!pose) return require(!pose.error().message.empty());
  require(pose->stamp_ns >= 0 && pose->T_odom_base.to_vector().allFinite());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  check_scan({data, size});
  check_odometry({data, size});
  return 0;
}
