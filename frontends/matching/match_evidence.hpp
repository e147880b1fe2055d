// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "cairn/geometry/se2.hpp"
#include "frontends/matching/scan_points.hpp"

namespace cairn {

/// Sums over the correspondences of one step, as seen from the scan; d in T Exp(d), m and rad.
class MatchEvidence {
 public:
  /// `width_m`: of the weights of Geman and McClure.
  explicit MatchEvidence(double width_m) : width_(width_m) {}

  /// In the order of the beams. `residual_m`: of the point from the line of `on`.
  void add(const SurfacePoint& point, const SurfacePoint& on, const Se2& T_map_scan,
           double residual_m);

  [[nodiscard]] double weights() const { return weights_; }
  [[nodiscard]] const Eigen::Matrix3d& hessian() const { return hessian_; }
  [[nodiscard]] const Eigen::Vector3d& gradient() const { return gradient_; }

  /// Projects onto the directions that surfaces fix. Normals are measured, so some of the hessian
  /// is their noise: a direction is free where there is little more than that (after Zhang et al.,
  /// "On degeneracy of optimization-based state estimation problems", ICRA 2016).
  struct Seen {
    Eigen::Matrix3d projection;                     ///< of tangents, onto what is fixed
    int free = 0;                                   ///< directions
    std::optional<Eigen::Vector3d> free_direction;  ///< the freest, of unit length (m, rad)
  };
  [[nodiscard]] Seen seen() const;

  /// Inverse covariance of what the surfaces say, zero in free directions: the sandwich of robust
  /// estimation (Huber, "Robust statistics", 1981, ch. 6) with the measured residuals, where those
  /// of neighboring beams err together.
  [[nodiscard]] Eigen::Matrix3d information(const Seen& seen) const;

 private:
  void close_run();

  double width_;
  double weights_ = 0.0, slopes_ = 0.0, squares_ = 0.0;  ///< sums of w, psi', psi^2
  double reach_squares_ = 0.0;                           ///< of weighted distances from the laser
  Eigen::Matrix3d hessian_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d feigned_ = Eigen::Matrix3d::Zero();  ///< by the noise of normals
  Eigen::Vector3d gradient_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d run_ = Eigen::Vector3d::Zero();  ///< of psi J, over neighbors
  Eigen::Vector3d run_squares_ = Eigen::Vector3d::Zero(), run_terms_ = Eigen::Vector3d::Zero();
  int in_run_ = 0;
};

/// The information about a difference of two, A and B of the parts: zero where either is. Where
/// both have free directions, these are taken for the same, and B for as good as A.
Eigen::Matrix3d parallel_sum(const Eigen::Matrix3d& A, const Eigen::Matrix3d& B);

}  // namespace cairn
