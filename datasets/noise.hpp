// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>

#include "cairn/factors/between.hpp"
#include "datasets/random.hpp"

namespace cairn {

/// Standard deviations of a relative pose, in its own frame. In the plane vertical_m and tilt_rad
/// have no meaning.
struct PoseSigmas {
  double ahead_m, sideways_m, vertical_m;
  double yaw_rad, tilt_rad;

  [[nodiscard]] PoseSigmas scaled(double factor) const {
    return {factor * ahead_m, factor * sideways_m, factor * vertical_m, factor * yaw_rad,
            factor * tilt_rad};
  }
};

/// Information of a measured T_a_b. The first translation axis is turned by `axis_rad` about the
/// vertical (a corridor is seen less sharply along its length), and half of the heading error
/// swings the translation, as along an arc: nothing is diagonal.
Eigen::Matrix3d pose_information(const PoseSigmas& sigmas, const Se2& T_a_b, double axis_rad);
Matrix6d pose_information(const PoseSigmas& sigmas, const Se3& T_a_b, double axis_rad);

/// The pose error with this error vector in g2o's chart: pose_error(pose_with_error(e)) == e. In
/// space the rotation part must be shorter than 2.
Se2 pose_with_error(const Eigen::Vector3d& e);
Se3 pose_with_error(const Vector6d& e);

/// e ~ N(0, Omega^-1) for a definite Omega.
template <int N>
Eigen::Matrix<double, N, 1> draw_error(const Eigen::Matrix<double, N, N>& information,
                                       Random& random) {
  Eigen::Matrix<double, N, 1> n;
  for (int i = 0; i < N; ++i) n[i] = random.normal();
  const Eigen::LLT<Eigen::Matrix<double, N, N>> llt(information);
  return llt.matrixU().solve(n);
}

/// A factor that measures T_a_b with the given information and an error drawn from it (`exact`:
/// none).
BetweenSe2 draw_between(const Se2& T_a_b, const Eigen::Matrix3d& information, bool exact,
                        Random& random);
BetweenSe3 draw_between(const Se3& T_a_b, const Matrix6d& information, bool exact, Random& random);

}  // namespace cairn
