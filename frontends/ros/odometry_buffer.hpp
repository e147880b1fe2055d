// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "frontends/ros/ros_messages.hpp"

namespace cairn {

/// The odometry of the last seconds, by stamp: says where the robot was when a scan was taken.
class OdometryBuffer {
 public:
  static constexpr std::int64_t kKeptNs = 5'000'000'000;
  static constexpr std::size_t kMost = 10'000;
  /// Poses further apart are not interpolated.
  static constexpr std::int64_t kMostApartNs = 1'000'000'000;
  /// A pose that is older than this says nothing of a scan.
  static constexpr std::int64_t kMostOldNs = 500'000'000;

  /// In any order; of two with the same stamp the later one holds. A stamp over 2 s behind the
  /// newest begins anew: what was before is forgotten.
  void add(const StampedPose& pose);
  /// Something with this stamp or a later one has come.
  [[nodiscard]] bool reaches(std::int64_t stamp_ns) const;
  /// Between the pose before and the one behind where these are near each other, else the one
  /// before unless it is too old, else nothing.
  [[nodiscard]] std::optional<Se2> at(std::int64_t stamp_ns) const;
  /// Nothing where it is empty.
  [[nodiscard]] std::optional<std::int64_t> newest_ns() const;

 private:
  std::deque<StampedPose> poses_;  ///< stamps rise
};

}  // namespace cairn
