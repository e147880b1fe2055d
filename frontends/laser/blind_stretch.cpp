// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/laser/blind_stretch.hpp"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

namespace cairn {
namespace {

constexpr std::size_t kRow = 10;  // scans

std::string describe_free(const PointToLineMatch& match) {
  if (match.free > 1 || !match.free_direction) return "nearly everything";
  const Eigen::Vector3d& d = *match.free_direction;
  if (std::abs(d.z()) > d.head<2>().norm()) return "turns";
  char text[64];
  std::snprintf(text, sizeof text, "shifts along %.0f deg to the left of ahead",
                std::atan2(d.y(), d.x()) * 180.0 / std::numbers::pi);
  return text;
}

}  // namespace

std::optional<std::string> BlindStretch::take(const PointToLineMatch& match, std::size_t keyframe) {
  ++scans_;
  free_ += match.free > 0 ? 1U : 0U;
  since_ += blind_ ? 1U : 0U;
  in_a_row_ = (match.free > 0) != blind_ ? in_a_row_ + 1 : 0;
  if (in_a_row_ < kRow) return std::nullopt;
  blind_ = !blind_;
  in_a_row_ = 0;
  const std::string at = "at keyframe " + std::to_string(keyframe);
  if (!blind_)
    return at + " surfaces show every direction again, after " +
           std::to_string(std::exchange(since_, 0)) + " scans";
  ++stretches_;
  return at + " scans begin to leave " + describe_free(match) +
         " free: only the predicted motion holds the map there";
}

std::string BlindStretch::summary() const {
  if (free_ == 0) return {};
  return std::to_string(free_) + " of " + std::to_string(scans_) +
         " scans left a direction free, in " + std::to_string(stretches_) +
         (stretches_ == 1 ? " stretch" : " stretches") + " of " + std::to_string(kRow) +
         " scans and more";
}

}  // namespace cairn
