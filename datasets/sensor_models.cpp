// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sensor_models.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace cairn {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPolarCorrelation = 0.3;

// What body x sees of its heading from above.
double heading(const Se3& T_map_body) {
  const Vector3d ahead = T_map_body.rotation() * Vector3d::UnitX();
  return std::atan2(ahead.y(), ahead.x());
}

// The unit vector m whose gravity error (factors/gravity.hpp) against g is e. With |e| = 2 sin(tilt
// / 2), g = cos(tilt) m + sin(tilt) B(m) e / |e|; B hardly moves with m, so the fixed point is
// reached in a few steps.
Vector3d down_with_error(const Vector3d& g, const Vector2d& e) {
  const double length = e.norm();
  if (length == 0.0) return g;
  const double tilt = 2.0 * std::asin(0.5 * length);
  Vector3d m = g;
  for (int i = 0; i < 60; ++i)
    m = (g - std::sin(tilt) / length * (gravity_tangent_basis(m) * e)).normalized();
  return m;
}

}  // namespace

Se3 SensorModels::mounting3() { return {So3::exp({0.1, -0.2, 0.3}), Vector3d(0.4, -0.1, 0.5)}; }

// 1/sigma^2 on the diagonal when uncorrelated; every pair of rows has the same correlation.
template <int N>
Eigen::Matrix<double, N, N> SensorModels::information(const Eigen::Matrix<double, N, 1>& sigmas,
                                                      double correlation) {
  Eigen::Matrix<double, N, N> covariance;
  covariance.setConstant(correlation);
  covariance.diagonal().setOnes();
  const Eigen::Matrix<double, N, N> inverse =
      (scale_ * sigmas.asDiagonal() * covariance * sigmas.asDiagonal() * scale_).inverse();
  return 0.5 * (inverse + inverse.transpose());
}

LandmarkXy SensorModels::landmark_xy(const Se2& T_map_body, const Vector2d& p_map) {
  const Vector2d p_sensor = (T_map_body * mounting2()).inverse() * p_map;
  // Sharper across the line of sight than along it.
  const Eigen::Matrix2d R_sensor_sight = So2(std::atan2(p_sensor.y(), p_sensor.x())).matrix();
  const Eigen::Matrix2d omega =
      R_sensor_sight * information<2>({0.08, 0.03}, 0.0) * R_sensor_sight.transpose();
  const Eigen::Matrix2d symmetric = 0.5 * (omega + omega.transpose());
  return {p_sensor - error<2>(symmetric), {mounting2(), kMounting2}, symmetric};
}

BearingXy SensorModels::bearing(const Se2& T_map_body, const Vector2d& p_map) {
  const Vector2d p_body = T_map_body.inverse() * p_map;
  const Scalar1d omega = information<1>(Scalar1d(0.01), 0.0);
  return {wrap_angle(std::atan2(p_body.y(), p_body.x()) - error<1>(omega)[0]), omega};
}

RangeXy SensorModels::range(const Se2& T_map_body, const Vector2d& p_map) {
  const Scalar1d omega = information<1>(Scalar1d(0.05), 0.0);
  return {(p_map - T_map_body.translation()).norm() - error<1>(omega)[0], omega};
}

RangeBearingXy SensorModels::range_bearing(const Se2& T_map_body, const Vector2d& p_map) {
  const Vector2d p_body = T_map_body.inverse() * p_map;
  const Eigen::Matrix2d omega = information<2>({0.08, 0.01}, kPolarCorrelation);
  const Vector2d e = error<2>(omega);
  return {p_body.norm() - e[0], wrap_angle(std::atan2(p_body.y(), p_body.x()) - e[1]), omega};
}

GnssSe2 SensorModels::gnss(const Se2& T_map_body) {
  const Vector2d p_body = antenna().head<2>();
  const Eigen::Matrix2d omega = information<2>({0.3, 0.4}, 0.4);
  return {p_body, T_map_body * p_body - error<2>(omega), omega};
}

YawSe2 SensorModels::yaw(const Se2& T_map_body) {
  const Scalar1d omega = information<1>(Scalar1d(0.02), 0.0);
  return {wrap_angle(T_map_body.theta() - error<1>(omega)[0]), omega};
}

PriorSe2 SensorModels::prior(const Se2& T_map_body) {
  const Eigen::Matrix3d omega = information<3>({0.2, 0.3, 0.03}, 0.25);
  return {T_map_body * pose_with_error(error<3>(omega)).inverse(), omega};
}

PriorXy SensorModels::position(const Se2& T_map_body) {
  const Eigen::Matrix2d omega = information<2>({0.3, 0.2}, -0.4);
  return {T_map_body.translation() - error<2>(omega), omega};
}

BetweenOffsetSe2 SensorModels::between_offset(const Se2& T_map_a, const Se2& T_map_b) {
  const SensorOffset<Se2> sensor{mounting2(), kMounting2};
  const Eigen::Matrix3d omega = information<3>({0.05, 0.08, 0.01}, 0.25);
  const Se2 T_a_b = (T_map_a * mounting2()).inverse() * (T_map_b * mounting2());
  return {draw_between(T_a_b, omega, exact_, random_).T_a_b_measured, sensor, sensor, omega};
}

LandmarkXyz SensorModels::landmark_xyz(const Se3& T_map_body, const Vector3d& p_map) {
  const Vector3d p_sensor = (T_map_body * mounting3()).inverse() * p_map;
  const Eigen::Matrix3d omega = information<3>({0.05, 0.06, 0.09}, 0.25);
  return {p_sensor - error<3>(omega), {mounting3(), kMounting3}, omega};
}

RangeXyz SensorModels::range(const Se3& T_map_body, const Vector3d& p_map) {
  const Scalar1d omega = information<1>(Scalar1d(0.05), 0.0);
  return {(p_map - T_map_body.translation()).norm() - error<1>(omega)[0], omega};
}

RangeBearingXyz SensorModels::range_bearing(const Se3& T_map_body, const Vector3d& p_map) {
  const Vector3d p = T_map_body.inverse() * p_map;
  const Eigen::Matrix3d omega = information<3>({0.08, 0.01, 0.015}, kPolarCorrelation);
  const Vector3d e = error<3>(omega);
  return {p.norm() - e[0], wrap_angle(std::atan2(p.y(), p.x()) - e[1]),
          std::atan2(p.z(), p.head<2>().norm()) - e[2], omega};
}

GnssSe3 SensorModels::gnss(const Se3& T_map_body) {
  const Eigen::Matrix3d omega = information<3>({0.3, 0.4, 0.8}, 0.3);
  return {antenna(), T_map_body * antenna() - error<3>(omega), omega};
}

Altitude SensorModels::altitude(const Se3& T_map_body) {
  const Scalar1d omega = information<1>(Scalar1d(0.2), 0.0);
  return {T_map_body.translation().z() - error<1>(omega)[0], omega};
}

YawSe3 SensorModels::yaw(const Se3& T_map_body) {
  const Scalar1d omega = information<1>(Scalar1d(0.02), 0.0);
  return {wrap_angle(heading(T_map_body) - error<1>(omega)[0]), omega};
}

Gravity SensorModels::gravity(const Se3& T_map_body) {
  const Eigen::Matrix2d omega = information<2>({0.01, 0.015}, 0.3);
  const Vector3d down_body = T_map_body.rotation().inverse() * Vector3d(0.0, 0.0, -1.0);
  return {down_with_error(down_body, error<2>(omega)), omega};
}

PriorSe3 SensorModels::prior(const Se3& T_map_body) {
  Vector6d sigmas;
  sigmas << 0.2, 0.3, 0.4, 0.02, 0.02, 0.03;
  const Matrix6d omega = information<6>(sigmas, 0.2);
  const Se3 T_map_sensor = T_map_body * mounting3();
  return {draw_between(T_map_sensor, omega, exact_, random_).T_a_b_measured,
          {mounting3(), kMounting3},
          omega};
}

BetweenOffsetSe3 SensorModels::between_offset(const Se3& T_map_a, const Se3& T_map_b) {
  const SensorOffset<Se3> sensor{mounting3(), kMounting3};
  Vector6d sigmas;
  sigmas << 0.05, 0.08, 0.06, 0.01, 0.012, 0.015;
  const Matrix6d omega = information<6>(sigmas, 0.2);
  const Se3 T_a_b = (T_map_a * mounting3()).inverse() * (T_map_b * mounting3());
  return {draw_between(T_a_b, omega, exact_, random_).T_a_b_measured, sensor, sensor, omega};
}

}  // namespace cairn
