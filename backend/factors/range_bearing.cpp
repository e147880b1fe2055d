// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/factors/range_bearing.hpp"

#include "cairn/factors/polar.hpp"

namespace cairn {
namespace {

// (range, azimuth, elevation) of p, and the derivative by p. The elevation is bearing_of(|xy|, z).
Eigen::Vector3d spherical(const Eigen::Vector3d& p, Eigen::Matrix3d& J) {
  Eigen::RowVector3d J_range;
  Eigen::RowVector2d J_azimuth, J_elevation, J_planar;
  const double range = range_of<3>(p, &J_range);
  const double azimuth = bearing_of(p.x(), p.y(), &J_azimuth);
  const double planar = range_of<2>(p.head<2>(), &J_planar);
  const double elevation = bearing_of(planar, p.z(), &J_elevation);
  J << J_range, J_azimuth, 0.0, J_elevation.x() * J_planar, J_elevation.y();
  return {range, azimuth, elevation};
}

}  // namespace

Eigen::Vector2d RangeBearingXy::error(const Se2& T_map_body, const Eigen::Vector2d& p_map,
                                      ErrorChart /*chart*/, Jacobian<2, 3>* J_e_pose,
                                      Jacobian<2, 2>* J_e_point) const {
  Jacobian<2, 3> J_p_pose;
  Jacobian<2, 2> J_p_point;
  const Eigen::Vector2d p_body = point_in_body(T_map_body, p_map, &J_p_pose, &J_p_point);
  Eigen::RowVector2d J_range_p, J_bearing_p;
  const double range = range_of<2>(p_body, &J_range_p);
  const double bearing = bearing_of(p_body.x(), p_body.y(), &J_bearing_p);
  if (J_e_pose) *J_e_pose << J_range_p * J_p_pose, J_bearing_p * J_p_pose;
  if (J_e_point) *J_e_point << J_range_p * J_p_point, J_bearing_p * J_p_point;
  return {range - range_m_measured, wrap_angle(bearing - bearing_rad_measured)};
}

bool RangeBearingXy::predict_last(const Se2& T_map_body, Eigen::Vector2d& p_map) const {
  p_map = T_map_body * Eigen::Vector2d(range_m_measured * std::cos(bearing_rad_measured),
                                       range_m_measured * std::sin(bearing_rad_measured));
  return true;
}

Eigen::Vector3d RangeBearingXyz::error(const Se3& T_map_body, const Eigen::Vector3d& p_map,
                                       ErrorChart /*chart*/, Jacobian<3, 6>* J_e_pose,
                                       Jacobian<3, 3>* J_e_point) const {
  Jacobian<3, 6> J_p_pose;
  Jacobian<3, 3> J_p_point;
  const Eigen::Vector3d p_body = point_in_body(T_map_body, p_map, &J_p_pose, &J_p_point);
  Eigen::Matrix3d J_spherical_p;
  const Eigen::Vector3d predicted = spherical(p_body, J_spherical_p);
  if (J_e_pose) *J_e_pose = J_spherical_p * J_p_pose;
  if (J_e_point) *J_e_point = J_spherical_p * J_p_point;
  return {predicted.x() - range_m_measured, wrap_angle(predicted.y() - azimuth_rad_measured),
          wrap_angle(predicted.z() - elevation_rad_measured)};
}

bool RangeBearingXyz::predict_last(const Se3& T_map_body, Eigen::Vector3d& p_map) const {
  const double planar = range_m_measured * std::cos(elevation_rad_measured);
  p_map = T_map_body * Eigen::Vector3d(planar * std::cos(azimuth_rad_measured),
                                       planar * std::sin(azimuth_rad_measured),
                                       range_m_measured * std::sin(elevation_rad_measured));
  return true;
}

template class TypedBatch<RangeBearingXy>;
template class TypedBatch<RangeBearingXyz>;

}  // namespace cairn
