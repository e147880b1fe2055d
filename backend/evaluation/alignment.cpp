// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/evaluation/alignment.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

#include "cairn/core/check.hpp"

namespace cairn {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// First and second moments of two point sets about their means.
struct Moments {
  Vector3d mean_reference = Vector3d::Zero(), mean_estimate = Vector3d::Zero();
  Matrix3d covariance = Matrix3d::Zero();  // sum of (reference)(estimate)^T
  double spread_reference = 0.0, spread_estimate = 0.0;
};

Moments compute_moments(std::span<const Se3> reference, std::span<const Se3> estimate) {
  Moments m;
  const auto count = static_cast<double>(reference.size());
  for (const Se3& T : reference) m.mean_reference += T.translation() / count;
  for (const Se3& T : estimate) m.mean_estimate += T.translation() / count;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const Vector3d r = reference[i].translation() - m.mean_reference;
    const Vector3d e = estimate[i].translation() - m.mean_estimate;
    m.covariance += r * e.transpose();
    m.spread_reference += r.squaredNorm();
    m.spread_estimate += e.squaredNorm();
  }
  return m;
}

// Rotation about z that maximizes trace(R^T covariance).
So3 yaw_rotation(const Moments& m, bool& determined) {
  const double sine = m.covariance(1, 0) - m.covariance(0, 1);
  const double cosine = m.covariance(0, 0) + m.covariance(1, 1);
  determined = std::hypot(sine, cosine) > 1e-12 * std::sqrt(m.spread_reference * m.spread_estimate);
  return determined ? So3::exp({0.0, 0.0, std::atan2(sine, cosine)}) : So3();
}

// Rotation that maximizes trace(R^T covariance): U diag(1, 1, det) V^T.
So3 full_rotation(const Moments& m, bool& determined) {
  const Eigen::JacobiSVD<Matrix3d> svd(m.covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vector3d& sigma = svd.singularValues();
  const double noise_floor = 1e-12 * std::sqrt(m.spread_reference * m.spread_estimate);
  determined = sigma[1] > noise_floor;
  if (sigma[0] <= noise_floor) return {};
  if (!determined) {
    const Eigen::Quaterniond q =
        Eigen::Quaterniond::FromTwoVectors(svd.matrixV().col(0), svd.matrixU().col(0));
    return So3(q);
  }
  Matrix3d S = Matrix3d::Identity();
  S(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return So3::project(svd.matrixU() * S * svd.matrixV().transpose());
}

}  // namespace

Alignment align(AlignmentKind kind, std::span<const Se3> reference, std::span<const Se3> estimate,
                bool planar) {
  CAIRN_CHECK(reference.size() == estimate.size() && !reference.empty(),
              "alignment of unmatched trajectories");
  Alignment result;
  if (kind == AlignmentKind::kNone) return result;
  const Moments m = compute_moments(reference, estimate);
  const bool about_z = planar || kind == AlignmentKind::kYaw;
  result.R_reference_estimate = about_z ? yaw_rotation(m, result.rotation_determined)
                                        : full_rotation(m, result.rotation_determined);
  if (kind == AlignmentKind::kSim3 && m.spread_estimate > 0.0) {
    const Matrix3d R = result.R_reference_estimate.matrix();
    result.scale = (R.transpose() * m.covariance).trace() / m.spread_estimate;
  }
  result.t_reference_estimate =
      m.mean_reference - result.scale * (result.R_reference_estimate * m.mean_estimate);
  return result;
}

}  // namespace cairn
