// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/laser/odometry_noise.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace cairn {
namespace {

constexpr double kMemoryWay = 30.0;  // what was learned earlier fades
constexpr double kLeastM = 1e-3, kLeastRad = 1e-3;
constexpr double kMostVariance = 0.02 * 0.02;  // of a match that odometry is compared with

}  // namespace

void OdometryNoise::learn(const Se2& odometry, const Se2& matched,
                          const Eigen::Matrix3d& information) {
  const Eigen::Vector3d e = (odometry.inverse() * matched).log();
  const Eigen::Matrix3d covariance = information.inverse();
  // Near a free direction it is worthless, and odometry would be judged by nothing.
  if (!(covariance.diagonal().minCoeff() > 0.0) ||
      !(covariance.diagonal().maxCoeff() < kMostVariance))
    return;
  const double way = OdometryNoise::way(odometry);
  const double keep = std::max(0.0, 1.0 - way / kMemoryWay);
  way_ = keep * way_ + way;
  squares_m_ = keep * squares_m_ +
               0.5 * std::max(0.0, e.head<2>().squaredNorm() - covariance(0, 0) - covariance(1, 1));
  squares_rad_ = keep * squares_rad_ + std::max(0.0, e.z() * e.z() - covariance(2, 2));
}

Eigen::Matrix3d OdometryNoise::information(double way) const {
  const double m = squares_m_ / way_ * way + kLeastM * kLeastM;
  const double rad = squares_rad_ / way_ * way + kLeastRad * kLeastRad;
  return Eigen::Vector3d(1.0 / m, 1.0 / m, 1.0 / rad).asDiagonal();
}

Eigen::Matrix3d OdometryNoise::information_of_detour(double way) const {
  const double rad = squares_rad_ / way_ * way + kLeastRad * kLeastRad;
  const double m = squares_m_ / way_ * way + kLeastM * kLeastM + rad * way * way;
  return Eigen::Vector3d(1.0 / m, 1.0 / m, 1.0 / rad).asDiagonal();
}

}  // namespace cairn
