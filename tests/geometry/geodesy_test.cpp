// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/geometry/geodesy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace cairn {
namespace {

// The half axes of WGS-84.
TEST(Geodesy, KnowsPolesAndEquator) {
  EXPECT_TRUE(to_earth({0.0, 0.0, 0.0}).isApprox(Eigen::Vector3d(6378137.0, 0.0, 0.0), 1e-15));
  EXPECT_TRUE(to_earth({0.0, 90.0, 10.0}).isApprox(Eigen::Vector3d(0.0, 6378147.0, 0.0), 1e-15));
  EXPECT_NEAR(to_earth({90.0, 0.0, 0.0}).z(), 6356752.314245179, 1e-8);
  EXPECT_NEAR(to_earth({-90.0, 0.0, 5.0}).z(), -6356757.314245179, 1e-8);
  EXPECT_NEAR(to_geodetic({0.0, 0.0, 6356752.314245179}).latitude_deg, 90.0, 1e-12);
  EXPECT_NEAR(to_geodetic({0.0, 0.0, 6356752.314245179}).height_m, 0.0, 1e-8);
}

// A degree along a meridian and along a parallel, from the radii of curvature M and N cos(phi).
TEST(Geodesy, MeasuresDegreesByTheRadiiOfCurvature) {
  const double latitude = 47.0, sine = std::sin(latitude * M_PI / 180.0);
  const double a = 6378137.0, f = 1.0 / 298.257223563, e2 = f * (2.0 - f);
  const double M = a * (1.0 - e2) / std::pow(1.0 - e2 * sine * sine, 1.5);
  const double N = a / std::sqrt(1.0 - e2 * sine * sine);
  const LocalFrame frame({latitude, 8.0, 0.0});
  const double step = 1e-4, radians = step * M_PI / 180.0;
  const Eigen::Vector3d north = frame.to_local({latitude + step, 8.0, 0.0});
  const Eigen::Vector3d east = frame.to_local({latitude, 8.0 + step, 0.0});
  EXPECT_NEAR(north.y(), M * radians, 1e-5);
  EXPECT_NEAR(north.x(), 0.0, 1e-8);
  EXPECT_NEAR(east.x(), N * std::sqrt(1.0 - sine * sine) * radians, 1e-5);
  EXPECT_NEAR(frame.to_local({latitude, 8.0, 12.5}).z(), 12.5, 1e-8);
}

TEST(Geodesy, GivesBackWhatItTook) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> latitude(-90.0, 90.0), longitude(-180.0, 180.0);
  std::uniform_real_distribution<double> height(-10e3, 100e3);
  for (int i = 0; i < 10'000; ++i) {
    const Geodetic place{latitude(random), longitude(random), height(random)};
    ASSERT_TRUE(is_place(place));
    const Geodetic back = to_geodetic(to_earth(place));
    EXPECT_LT((to_earth(back) - to_earth(place)).norm(), 5e-9);
    EXPECT_NEAR(back.height_m, place.height_m, 5e-9);
    EXPECT_NEAR(back.latitude_deg, place.latitude_deg, 1e-13);
    const LocalFrame frame({latitude(random), longitude(random), 0.0});
    EXPECT_LT((to_earth(frame.to_geodetic(frame.to_local(place))) - to_earth(place)).norm(), 2e-8);
  }
}

TEST(Geodesy, TurnsAxesBetweenDatums) {
  const Geodetic here{60.0, 10.0, 100.0}, there{61.0, 12.0, 0.0};
  const LocalFrame a(here), b(there);
  const Geodetic place{60.5, 11.0, 50.0};
  EXPECT_LT((a.to_local(there) + a.axes_of(b) * b.to_local(place) - a.to_local(place)).norm(),
            1e-8);
}

TEST(Geodesy, KnowsWhatIsNoPlace) {
  for (const Geodetic& place :
       {Geodetic{90.1, 0.0, 0.0}, Geodetic{0.0, -180.1, 0.0}, Geodetic{0.0, 0.0, 1e6},
        Geodetic{0.0, 0.0, -1e5}, Geodetic{std::nan(""), 0.0, 0.0}, Geodetic{0.0, 0.0, INFINITY}})
    EXPECT_FALSE(is_place(place));
}

}  // namespace
}  // namespace cairn
