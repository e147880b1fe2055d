// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/geometry/geodesy.hpp"

#include <Eigen/Geometry>
#include <charconv>
#include <cmath>
#include <numbers>

namespace cairn {
namespace {

// WGS-84: half axis, flattening, and the first eccentricity squared.
constexpr double kA = 6'378'137.0, kF = 1.0 / 298.257223563, kE2 = kF * (2.0 - kF);
constexpr double kRadians = std::numbers::pi / 180.0;

// From the axis of the earth to the surface, along the normal.
double normal_radius(double sin_latitude) {
  return kA / std::sqrt(1.0 - kE2 * sin_latitude * sin_latitude);
}

std::string shortest_text(double number) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, number).ptr};
}

}  // namespace

std::string to_string(const Geodetic& place) {
  return shortest_text(place.latitude_deg) + ' ' + shortest_text(place.longitude_deg) + ' ' +
         shortest_text(place.height_m);
}

bool is_place(const Geodetic& place) {
  return std::abs(place.latitude_deg) <= 90.0 && std::abs(place.longitude_deg) <= 180.0 &&
         place.height_m >= -10e3 && place.height_m <= 100e3;
}

Eigen::Vector3d to_earth(const Geodetic& place) {
  const double latitude = place.latitude_deg * kRadians;
  const double longitude = place.longitude_deg * kRadians;
  const double normal = normal_radius(std::sin(latitude));
  const double from_axis = (normal + place.height_m) * std::cos(latitude);
  return {from_axis * std::cos(longitude), from_axis * std::sin(longitude),
          (normal * (1.0 - kE2) + place.height_m) * std::sin(latitude)};
}

Geodetic to_geodetic(const Eigen::Vector3d& p_earth) {
  const double from_axis = std::hypot(p_earth.x(), p_earth.y()), z = p_earth.z();
  // The parametric latitude; Bowring (1976), equation for tan(phi). Two rounds reach 1e-9 m.
  double parametric = std::atan2(z, (1.0 - kF) * from_axis), latitude = 0.0;
  for (int round = 0; round < 3; ++round) {
    const double s = std::sin(parametric), c = std::cos(parametric);
    latitude = std::atan2(z + kE2 / (1.0 - kF) * kA * s * s * s, from_axis - kE2 * kA * c * c * c);
    parametric = std::atan2((1.0 - kF) * std::sin(latitude), std::cos(latitude));
  }
  // Good at the poles and at the equator.
  const double s = std::sin(latitude), normal = normal_radius(s);
  const double height = from_axis * std::cos(latitude) + z * s - kA * kA / normal;
  return {latitude / kRadians, std::atan2(p_earth.y(), p_earth.x()) / kRadians, height};
}

LocalFrame::LocalFrame(const Geodetic& datum) : origin_(to_earth(datum)) {
  const double latitude = datum.latitude_deg * kRadians, longitude = datum.longitude_deg * kRadians;
  const Eigen::Vector3d east(-std::sin(longitude), std::cos(longitude), 0.0);
  const Eigen::Vector3d up(std::cos(latitude) * std::cos(longitude),
                           std::cos(latitude) * std::sin(longitude), std::sin(latitude));
  R_earth_local_ << east, up.cross(east), up;
}

Eigen::Vector3d LocalFrame::to_local(const Geodetic& place) const {
  return R_earth_local_.transpose() * (to_earth(place) - origin_);
}

Geodetic LocalFrame::to_geodetic(const Eigen::Vector3d& p_local) const {
  return cairn::to_geodetic(origin_ + R_earth_local_ * p_local);
}

}  // namespace cairn
