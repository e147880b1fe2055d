// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/maps/range_scan.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "cairn/core/bytes.hpp"

namespace cairn {
namespace {

constexpr std::uint16_t kVersion = 1;
constexpr double kMaxAngle = 100.0;      // rad
constexpr double kMaxDistance = 10'000;  // m

bool is_within(double value, double limit) { return std::abs(value) <= limit; }  // NaN is not

// What is wrong with it; null: nothing.
const char* find_fault(const RangeScan& scan) {
  if (scan.ranges_m.size() > kMaxBeams) return "has more than 100000 beams";
  if (!is_within(scan.first_angle_rad, kMaxAngle))
    return "has a first angle that is no number from -100 to 100 rad";
  if (!is_within(scan.angle_step_rad, kMaxAngle))
    return "has an angle between beams that is no number from -100 to 100 rad";
  if (!(scan.max_range_m > 0.0) || !is_within(scan.max_range_m, kMaxDistance))
    return "has a max range that is no number above 0 and up to 10000 m";
  if (!is_within(scan.T_body_laser.x(), kMaxDistance) ||
      !is_within(scan.T_body_laser.y(), kMaxDistance))
    return "has its laser further than 10000 m from the body, or nowhere";
  if (!is_within(scan.T_body_laser.theta(), std::numbers::pi))
    return "has a laser that looks nowhere";
  return nullptr;
}

bool is_reading(float range_m) { return std::isfinite(range_m) && range_m > 0.0F; }

Error not_a_scan(const std::string& why, std::size_t at) {
  return {ErrorCode::kBadInput, "this is no laser_scan/1: it " + why, "byte " + std::to_string(at)};
}

}  // namespace

Result<std::string> encode(const RangeScan& scan) {
  if (const char* fault = find_fault(scan))
    return Error{ErrorCode::kBadInput, std::string("the scan ") + fault};
  std::string bytes;
  ByteWriter out(bytes);
  out.integer(kVersion);
  for (const double number :
       {scan.first_angle_rad, scan.angle_step_rad, scan.max_range_m, scan.T_body_laser.x(),
        scan.T_body_laser.y(), scan.T_body_laser.theta()})
    out.real(number);
  out.count(scan.ranges_m.size());
  for (const float range : scan.ranges_m)
    out.integer(std::bit_cast<std::uint32_t>(is_reading(range) ? range : 0.0F));
  return bytes;
}

Result<RangeScan> decode_range_scan(std::string_view bytes) {
  ByteReader in(bytes);
  if (in.integer<std::uint16_t>() != kVersion) in.fail("has an unknown version; 1 is expected");
  RangeScan scan;
  scan.first_angle_rad = in.real();
  scan.angle_step_rad = in.real();
  scan.max_range_m = in.real();
  const double x = in.real(), y = in.real(), theta = in.real();
  if (!(theta > -std::numbers::pi && theta <= std::numbers::pi))
    in.fail("has a laser whose angle is not in (-pi, pi]");
  const std::size_t beams = in.count(sizeof(float));
  if (in.ok() && beams > kMaxBeams) in.fail("has more than 100000 beams");
  if (!in.ok()) return not_a_scan(std::string(in.problem()), in.place());
  scan.T_body_laser = Se2(x, y, theta);
  scan.ranges_m.resize(beams);
  for (float& range : scan.ranges_m) {
    const auto bits = in.integer<std::uint32_t>();
    range = std::bit_cast<float>(bits);
    if (bits != 0 && !is_reading(range)) in.fail("has a range that is neither 0 nor a distance");
  }
  if (in.left() != 0) in.fail("goes on behind its last beam");
  if (!in.ok()) return not_a_scan(std::string(in.problem()), in.place());
  if (const char* fault = find_fault(scan)) return not_a_scan(fault, 0);
  return scan;
}

}  // namespace cairn
