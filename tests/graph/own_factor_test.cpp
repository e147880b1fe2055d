// SPDX-License-Identifier: BSD-3-Clause
// The example of backend/graph/README.md and tests/support/README.md.
#include <gtest/gtest.h>

#include "cairn/graph/graph.hpp"
#include "tests/support/factor_checks.hpp"

namespace cairn::test {
namespace {

/// The straight distance between two planar poses. e = |t_map_b - t_map_a| - distance, m.
struct TravelDistance {
  static constexpr std::string_view kName = "travel_distance";
  using Variables = Signature<VariableType::kPose2, VariableType::kPose2>;
  static constexpr int kDimension = 1;
  static constexpr bool kAbsolute = false;  // moving a and b together changes nothing

  double distance_m_measured;
  Eigen::Matrix<double, 1, 1> information;  // 1/m^2

  Eigen::Matrix<double, 1, 1> error(const Se2& T_map_a, const Se2& T_map_b, ErrorChart /*chart*/,
                                    Eigen::Matrix<double, 1, 3>* J_e_a,
                                    Eigen::Matrix<double, 1, 3>* J_e_b) const {
    const Eigen::Vector2d step = T_map_b.translation() - T_map_a.translation();
    const double distance = step.norm();
    const Eigen::Vector2d u = step / std::max(distance, 1e-9);
    if (J_e_a) *J_e_a << -u.transpose() * T_map_a.rotation().matrix(), 0.0;
    if (J_e_b) *J_e_b << u.transpose() * T_map_b.rotation().matrix(), 0.0;
    return Eigen::Matrix<double, 1, 1>(distance - distance_m_measured);
  }
};

TEST(OwnFactor, IsAddedLikeAnyOther) {
  Graph graph;
  ASSERT_TRUE(graph.add_pose2(VariableId{0}, Se2(0.0, 0.0, 0.0)));
  ASSERT_TRUE(graph.add_pose2(VariableId{1}, Se2(3.0, 4.0, 0.5)));
  const TravelDistance factor{4.5, Eigen::Matrix<double, 1, 1>(100.0)};
  const auto added = graph.add_factor(factor, {VariableId{0}, VariableId{1}});
  ASSERT_TRUE(added) << added.error().to_string();

  const FactorBatch& batch = *graph.batches()[added->batch];
  EXPECT_NEAR(batch.evaluate_cost(0, 1, {graph.values()}).chi2, 25.0,
              1e-12);  // (5.0 - 4.5)^2 * 100
}

TEST(OwnFactor, IsSound) {
  expect_factor_is_sound<TravelDistance>([](Random& random) {
    return TravelDistance{random.uniform(0.0, 20.0), random.information<1>()};
  });
}

}  // namespace
}  // namespace cairn::test
