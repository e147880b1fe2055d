// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/drawing/projection.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace cairn::drawing {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kFlat = 0.04;  // smallest over middle standard deviation
constexpr double kElevation_rad = 30.0 * std::numbers::pi / 180.0;
constexpr double kTurn_rad =
    30.0 * std::numbers::pi / 180.0;  // of the longest horizontal extent out of the page

Matrix3d covariance(std::span<const Vector3d> points) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : points) mean += p / static_cast<double>(points.size());
  Matrix3d sum = Matrix3d::Zero();
  for (const Vector3d& p : points)
    sum += (p - mean) * (p - mean).transpose() / static_cast<double>(points.size());
  return sum;
}

Matrix3d view_from(const Vector3d& eye, const Vector3d& right_hint) {
  const Vector3d right = (right_hint - eye * eye.dot(right_hint)).normalized();
  Matrix3d R;
  R << right.transpose(), eye.cross(right).transpose(), eye.transpose();
  return R;
}

// Looks along the normal of a plane so that two coordinate axes keep their usual place on the page.
Matrix3d face_on(Vector3d normal) {
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  const Vector3d toward_eye = axis == 1 ? Vector3d(0, -1, 0) : Vector3d(Vector3d::Unit(axis));
  if (normal.dot(toward_eye) < 0) normal = -normal;
  return view_from(normal, axis == 0 ? Vector3d::UnitY() : Vector3d::UnitX());
}

Matrix3d oblique(const Matrix3d& spread) {
  // Angle of the longest horizontal extent; of a round one, the x axis.
  const double along = 0.5 * std::atan2(2 * spread(0, 1), spread(0, 0) - spread(1, 1));
  const double azimuth = along - std::numbers::pi / 2 - kTurn_rad;
  const Vector3d eye(std::cos(kElevation_rad) * std::cos(azimuth),
                     std::cos(kElevation_rad) * std::sin(azimuth), std::sin(kElevation_rad));
  return view_from(eye, Vector3d::UnitZ().cross(eye));
}

}  // namespace

Projection choose_projection(std::span<const Vector3d> points) {
  const Matrix3d spread = points.empty() ? Matrix3d(Matrix3d::Zero()) : covariance(points);
  if (spread.row(2).cwiseAbs().maxCoeff() <= 1e-12 * spread.trace())
    return {};  // planar, or a single point
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(spread);
  const Vector3d deviations = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const bool is_line = deviations(1) <= kFlat * deviations(2);
  if (!is_line && deviations(0) <= kFlat * deviations(1))
    return {face_on(eigen.eigenvectors().col(0)), false};
  return {oblique(spread), true};
}

}  // namespace cairn::drawing
