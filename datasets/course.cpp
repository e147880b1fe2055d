// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <numbers>

#include "datasets/walk.hpp"

namespace cairn {
namespace {

constexpr double kTau = 2.0 * std::numbers::pi;

}  // namespace

Eigen::Vector3d Course::position(double station) const {
  const double angle = kTau * station / lap_m;
  const double radius_m = lap_m / kTau * (1.0 + 0.15 * std::cos(3.0 * angle));
  const double z_m = 4.0 * std::sin(kTau * station / 20.0);
  return {radius_m * std::cos(angle), radius_m * std::sin(angle), z_m};
}

Eigen::Vector3d Course::ahead(double station) const {
  return (position(station + 0.1) - position(station - 0.1)).normalized();
}

Walk<Se2> Course::walk2(std::size_t poses) const {
  Walk<Se2> walk;
  for (std::size_t i = 0; i < poses; ++i) {
    const auto station = static_cast<double>(i);
    const Eigen::Vector3d p = position(station), a = ahead(station);
    walk.poses.emplace_back(p.x(), p.y(), std::atan2(a.y(), a.x()));
  }
  return walk;
}

Walk<Se3> Course::walk3(std::size_t poses) const {
  Walk<Se3> walk;
  for (std::size_t i = 0; i < poses; ++i) {
    const auto station = static_cast<double>(i);
    const double angle = kTau * station / lap_m;
    const Eigen::Vector3d up(0.3 * std::cos(7.0 * angle), 0.3 * std::sin(5.0 * angle), 1.0);
    walk.poses.push_back(pose_looking(position(station), ahead(station), up));
  }
  return walk;
}

}  // namespace cairn
