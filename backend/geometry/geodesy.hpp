// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>

namespace cairn {

/// A place on the WGS-84 ellipsoid: geodetic latitude and longitude (deg, north and east positive),
/// height above the ellipsoid (m).
struct Geodetic {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double height_m = 0.0;

  friend bool operator==(const Geodetic&, const Geodetic&) = default;
};

/// "47.3977 8.5456 408": latitude, longitude, height, with all their digits.
std::string to_string(const Geodetic& place);

/// Latitude and longitude are those of a place, the height is between 10 km below the ellipsoid and
/// 100 km above.
bool is_place(const Geodetic& place);

/// Axes of the earth (m): x to latitude and longitude 0, z to the north pole.
Eigen::Vector3d to_earth(const Geodetic& place);
/// The inverse, by Bowring's iteration; to 1e-9 m for heights that is_place() takes.
Geodetic to_geodetic(const Eigen::Vector3d& p_earth);

/// The frame at a datum whose axes point east, north and up.
class LocalFrame {
 public:
  explicit LocalFrame(const Geodetic& datum);
  /// m, in this frame.
  [[nodiscard]] Eigen::Vector3d to_local(const Geodetic& place) const;
  [[nodiscard]] Geodetic to_geodetic(const Eigen::Vector3d& p_local) const;
  /// Turns east-north-up axes of another datum into ours.
  [[nodiscard]] Eigen::Matrix3d axes_of(const LocalFrame& other) const {
    return R_earth_local_.transpose() * other.R_earth_local_;
  }

 private:
  Eigen::Vector3d origin_;
  Eigen::Matrix3d R_earth_local_;
};

}  // namespace cairn
