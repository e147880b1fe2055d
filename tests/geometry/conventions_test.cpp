// SPDX-License-Identifier: BSD-3-Clause
// The example of backend/geometry/README.md.
#include "cairn/geometry/information.hpp"
#include "cairn/geometry/se2.hpp"
#include "tests/support/matrix_matchers.hpp"

namespace cairn::test {
namespace {

TEST(Conventions, AreWhatTheReadmeSays) {
  // clang-format off
  const Se2 T_map_body(1.0, 2.0, std::numbers::pi / 2.0);
  const Eigen::Vector2d p_map = T_map_body * Eigen::Vector2d(1.0, 0.0);  // ahead of the body: (1, 3)
  const Se2 moved = T_map_body.retract({0.5, 0.0, 0.0});                 // half a meter ahead: (1, 2.5)
  const Eigen::Matrix3d Omega = information_from_sigmas<3>({0.1, 0.1, 0.02});
  // clang-format on
  EXPECT_THAT(p_map, is_near(Eigen::Vector2d(1.0, 3.0), 1e-15));
  EXPECT_THAT(moved.translation(), is_near(Eigen::Vector2d(1.0, 2.5), 1e-15));
  EXPECT_NEAR(Omega(2, 2), 2500.0, 1e-9);
}

}  // namespace
}  // namespace cairn::test
