// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/matching/match_evidence.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace cairn {
namespace {

constexpr double kFree = 3.0;        // hessian over what noise feigns of it
constexpr int kRun = 16;             // beams that err together, about
constexpr double kPriorRuns = 20.0;  // weight of the share that is expected, in runs
constexpr double kExpectedShare = 1.5;
constexpr double kLeastSpreadM = 0.003;  // of echoes: no laser is better

// The tangent of a point on a line with this normal: how much further a motion brings it.
Eigen::Vector3d along(const Eigen::Vector2d& normal, const Eigen::Vector2d& position) {
  return {normal.x(), normal.y(), normal.y() * position.x() - normal.x() * position.y()};
}

// Rounding, or more noise than there is information, leaves negative parts.
Eigen::Matrix3d nearest_semidefinite(const Eigen::Matrix3d& A) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(0.5 * (A + A.transpose()));
  const Eigen::Matrix3d root =
      eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  return root * root.transpose();
}

int rank(const Eigen::Matrix3d& A) {
  const Eigen::Vector3d values = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(A).eigenvalues();
  return static_cast<int>((values.array() > 1e-9 * values[2]).count());
}

}  // namespace

void MatchEvidence::add(const SurfacePoint& point, const SurfacePoint& on, const Se2& T_map_scan,
                        double r) {
  const Eigen::Vector2d n = T_map_scan.rotation().inverse() * on.normal;
  const Eigen::Vector3d J = along(n, point.position);
  const double u2 = (r / width_) * (r / width_);
  const double root = 1.0 / (1.0 + u2);
  const double weight = root * root, psi = weight * r;
  hessian_ += weight * J * J.transpose();
  gradient_ += psi * J;
  // J of a normal turned by a small angle: J + angle * across - angle^2 / 2 * J.
  const Eigen::Vector3d across = along({-n.y(), n.x()}, point.position);
  feigned_ += weight * on.normal_variance * (across * across.transpose());
  weights_ += weight;
  slopes_ += (1.0 - 3.0 * u2) * root * weight;
  squares_ += psi * psi;
  reach_squares_ += weight * point.position.squaredNorm();
  run_terms_ += psi * psi * J.cwiseAbs2();
  run_ += psi * J;
  if (++in_run_ == kRun) close_run();
}

void MatchEvidence::close_run() {
  run_squares_ += run_.cwiseAbs2();
  run_.setZero();
  in_run_ = 0;
}

MatchEvidence::Seen MatchEvidence::seen() const {
  Seen seen{Eigen::Matrix3d::Identity(), 0, std::nullopt};
  if (weights_ <= 0.0) {
    seen.projection.setZero();
    seen.free = 3;
    seen.free_direction = Eigen::Vector3d::UnitX();
    return seen;
  }
  // Turns in units in which they move the points by as much as shifts do.
  const double length = std::sqrt(reach_squares_ / weights_) + 1e-3;
  const Eigen::Vector3d scale(1.0, 1.0, length);
  const Eigen::Matrix3d H =
      scale.cwiseInverse().asDiagonal() * hessian_ * scale.cwiseInverse().asDiagonal();
  const Eigen::Matrix3d N =
      scale.cwiseInverse().asDiagonal() * feigned_ * scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(H);
  Eigen::Matrix3d kept = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d v = eigen.eigenvectors().col(k);
    if (eigen.eigenvalues()[k] > kFree * v.dot(N * v) + 1e-9) {
      kept += v * v.transpose();
    } else if (++seen.free == 1) {
      seen.free_direction = (v.array() / scale.array()).matrix().normalized();
    }
  }
  if (seen.free > 0)
    seen.projection = scale.cwiseInverse().asDiagonal() * kept * scale.asDiagonal();
  return seen;
}

Eigen::Matrix3d MatchEvidence::information(const Seen& seen) const {
  if (weights_ <= 0.0 || slopes_ <= 0.0) return Eigen::Matrix3d::Zero();
  const Eigen::Vector3d runs = run_squares_ + run_.cwiseAbs2();
  double together = 0.0;
  for (int k = 0; k < 3; ++k) together += runs[k] / std::max(run_terms_[k], 1e-12) / 3.0;
  const double count = std::max(1.0, weights_ / kRun);
  together = std::max(1.0, (kPriorRuns * kExpectedShare + count * together) / (kPriorRuns + count));
  const double squares = squares_ + kLeastSpreadM * kLeastSpreadM * weights_;
  const double per_weight = slopes_ * slopes_ / (weights_ * squares * together);
  const Eigen::Matrix3d P = seen.projection;
  return per_weight * nearest_semidefinite(P.transpose() * (hessian_ - feigned_) * P);
}

Eigen::Matrix3d parallel_sum(const Eigen::Matrix3d& A, const Eigen::Matrix3d& B) {
  // Free directions of two, a little apart, would make all between them free.
  if (rank(A) < 3 && rank(B) < 3) return 0.5 * A;
  Eigen::Matrix3d sum = A + B;
  const double least = 1e-12 * (sum.trace() + 1e-12);
  sum.diagonal().array() += least;
  return nearest_semidefinite(A * sum.inverse() * B);
}

}  // namespace cairn
