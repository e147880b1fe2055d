// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/lie_laws.hpp"

namespace cairn::test {
namespace {

constexpr std::uint64_t kSeed = 7;

template <class Group>
class LieGroups : public testing::Test {};
using Groups = testing::Types<Se2, So3, Se3>;
TYPED_TEST_SUITE(LieGroups, Groups);

TYPED_TEST(LieGroups, ExpAndLogAreInverse) { expect_exp_and_log_are_inverse<TypeParam>(kSeed); }
TYPED_TEST(LieGroups, ObeyTheGroupLaws) { expect_group_laws<TypeParam>(kSeed); }
TYPED_TEST(LieGroups, AdjointMovesPerturbationsToTheLeft) {
  expect_adjoint_moves_perturbations_to_the_left<TypeParam>(kSeed);
}

template <class Group>
class PoseGroups : public testing::Test {};
using Poses = testing::Types<Se2, Se3>;
TYPED_TEST_SUITE(PoseGroups, Poses);

TYPED_TEST(PoseGroups, RetractionIsUndoneByTheLocalCoordinates) {
  expect_retraction_is_undone<TypeParam>(kSeed);
}

template <class Group>
class SpatialGroups : public testing::Test {};
using Spatial = testing::Types<So3, Se3>;
TYPED_TEST_SUITE(SpatialGroups, Spatial);

TYPED_TEST(SpatialGroups, RightJacobianInverseMatchesDifferences) {
  expect_right_jacobian_inverse_matches_differences<TypeParam>(kSeed);
}

// Just below and just above a threshold the two formulas must give the same number: what changes
// over 2e-9 of the angle is below 1e-8 of a translation of a few metres.
template <class Function>
void expect_continuous(double threshold, Function at) {
  const auto below = at(threshold * (1.0 - 1e-9));
  const auto above = at(threshold * (1.0 + 1e-9));
  EXPECT_THAT(above, is_near(below, 20.0 * threshold * 1e-9 + 1e-14)) << "threshold " << threshold;
}

TEST(Se2, SmallAngleBranchesAreContinuous) {
  for (const double sign : {-1.0, 1.0}) {
    expect_continuous(5e-3, [&](double t) -> Eigen::VectorXd {
      return Se2::exp({2.0, -3.0, sign * t}).to_vector();
    });
    expect_continuous(5e-3,
                      [&](double t) -> Eigen::VectorXd { return Se2(2.0, -3.0, sign * t).log(); });
  }
}

TEST(Se3, SmallAngleBranchesAreContinuous) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, -2.0, 0.5).normalized();
  const auto tangent = [&](double t) {
    Se3::Tangent v;
    v << 2.0, -3.0, 1.0, t * axis;
    return v;
  };
  for (const double threshold : {1e-4, 2e-4, 1e-2, 5e-2}) {
    expect_continuous(threshold, [&](double t) -> Eigen::VectorXd {
      return homogeneous(Se3::exp(tangent(t))).reshaped();
    });
    expect_continuous(threshold, [&](double t) -> Eigen::VectorXd {
      return Se3(So3::exp(t * axis), {2.0, -3.0, 1.0}).log();
    });
    expect_continuous(threshold, [&](double t) -> Eigen::VectorXd {
      return Se3::right_jacobian_inverse(tangent(t)).reshaped();
    });
  }
}

TEST(So2, WrapsAnglesIntoTheHalfOpenInterval) {
  constexpr double kPi = std::numbers::pi;
  EXPECT_EQ(wrap_angle(kPi), kPi);
  EXPECT_EQ(wrap_angle(-kPi), kPi);
  EXPECT_NEAR(wrap_angle(3.0 * kPi), kPi, 1e-15);
  EXPECT_NEAR(wrap_angle(-3.5 * kPi), 0.5 * kPi, 1e-15);
  EXPECT_NEAR(wrap_angle(200.0 * kPi + 0.25), 0.25, 1e-12);
  EXPECT_EQ(wrap_angle(-0.75), -0.75);
}

TEST(So2, KeepsTheAngleItWasGiven) { EXPECT_EQ(So2(0.1).angle(), 0.1); }

TEST(So2, ComposesAndInvertsLikeAngles) {
  Random random(kSeed);
  for (int i = 0; i < 1000; ++i) {
    const double a = random.angle(), b = random.angle();
    const So2 product = So2(a) * So2(b);
    EXPECT_NEAR(std::remainder(product.angle() - a - b, 2.0 * std::numbers::pi), 0.0, 1e-15);
    EXPECT_THAT(product.matrix(), is_near(So2(a + b).matrix(), 1e-15));
    EXPECT_THAT((So2(a) * So2(a).inverse()).matrix(), is_near(Eigen::Matrix2d::Identity(), 1e-15));
    EXPECT_GT(product.angle(), -std::numbers::pi);
    EXPECT_LE(product.angle(), std::numbers::pi);
  }
}

TEST(So2, HalfTurnIsItsOwnInverse) {
  EXPECT_EQ(So2(std::numbers::pi).inverse().angle(), std::numbers::pi);
}

TEST(So3, LogarithmOfAHalfTurnHasLengthPiAndTheAxis) {
  Random random(kSeed);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d axis = random.vector<3>().normalized();
    const Eigen::Vector3d v = So3::exp(std::numbers::pi * axis).log();
    EXPECT_NEAR(v.norm(), std::numbers::pi, 1e-14);
    EXPECT_NEAR(std::abs(v.normalized().dot(axis)), 1.0, 1e-14);
  }
}

TEST(So3, LogarithmDoesNotDependOnTheSignOfTheQuaternion) {
  Random random(kSeed);
  const So3 R = random.rotation3();
  const So3 same(Eigen::Quaterniond(-R.quaternion().coeffs()));
  EXPECT_THAT(same.log(), is_near(R.log(), 0.0));
}

TEST(So3, KeepsAQuaternionThatIsNormalizedToABillionth) {
  const Eigen::Quaterniond q(0.5 + 4e-10, 0.5, 0.5, 0.5);
  EXPECT_EQ(So3(q).quaternion().coeffs(), q.coeffs());
  const Eigen::Quaterniond far(0.5 + 1e-8, 0.5, 0.5, 0.5);
  EXPECT_NEAR(So3(far).quaternion().norm(), 1.0, 1e-15);
}

TEST(So3, ProjectionFindsTheNearestRotation) {
  Random random(kSeed);
  for (int i = 0; i < 100; ++i) {
    const So3 R = random.rotation3();
    Eigen::Matrix3d stretch = 0.2 * random.information<3>() + Eigen::Matrix3d::Identity();
    // M = R S with S symmetric positive definite is the polar decomposition: R is nearest.
    EXPECT_THAT(So3::project(R.matrix() * stretch).matrix(), is_near(R.matrix(), 1e-12));
    stretch.col(2) *= -1.0;
    EXPECT_NEAR(So3::project(stretch).matrix().determinant(), 1.0, 1e-12)
        << "a reflection was kept";
  }
}

TEST(Se3, LongChainsOfRetractionsStayNormalized) {
  Random random(kSeed);
  Se3 T;
  for (int i = 0; i < 10000; ++i) T = T.retract(random.vector<6>());
  EXPECT_NEAR(T.rotation().quaternion().norm(), 1.0, 1e-15);
}

TEST(Se2, LongChainsOfRetractionsStayNormalized) {
  Random random(kSeed);
  Se2 T;
  for (int i = 0; i < 10000; ++i) T = T.retract(random.vector<3>());
  EXPECT_NEAR(std::hypot(T.rotation().cos(), T.rotation().sin()), 1.0, 1e-15);
}

}  // namespace
}  // namespace cairn::test
