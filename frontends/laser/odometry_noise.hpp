// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "cairn/geometry/se2.hpp"

namespace cairn {

/// How far odometry is off, learned where scans say where the robot went. Variances grow with the
/// way: metres and radians added up.
class OdometryNoise {
 public:
  /// Sigmas over one m or rad, believed until as much way has been seen as `after_way`.
  struct Prior {
    double sigma_m = 0.05, sigma_rad = 0.05, after_way = 2.0;
  };
  explicit OdometryNoise(const Prior& prior)
      : squares_m_(prior.sigma_m * prior.sigma_m * prior.after_way),
        squares_rad_(prior.sigma_rad * prior.sigma_rad * prior.after_way),
        way_(prior.after_way) {}

  static double way(const Se2& step) { return step.translation().norm() + std::abs(step.theta()); }

  /// Odometry told one motion, scans (with this information) another.
  void learn(const Se2& odometry, const Se2& matched, const Eigen::Matrix3d& information);

  /// Inverse covariance (m, rad) of odometry over a way.
  [[nodiscard]] Eigen::Matrix3d information(double way) const;
  /// The same where the heading has drifted all along the way, and led the robot aside.
  [[nodiscard]] Eigen::Matrix3d information_of_detour(double way) const;

 private:
  double squares_m_, squares_rad_, way_;
};

}  // namespace cairn
