// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/evaluation/alignment.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "datasets/random.hpp"

namespace cairn {
namespace {

using Eigen::Vector3d;

// Ten digits: least squares on coordinates of some metres in double precision.
constexpr double kTolerance = 1e-10;

std::vector<Se3> random_poses(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Se3> poses;
  const auto vector = [&](double scale) -> Vector3d {
    return scale * Vector3d(random.normal(), random.normal(), random.normal());
  };
  for (std::size_t i = 0; i < count; ++i) poses.emplace_back(So3::exp(vector(1.0)), vector(5.0));
  return poses;
}

// The estimate that a known alignment maps onto the reference.
std::vector<Se3> moved_away(const std::vector<Se3>& reference, const So3& R, const Vector3d& t,
                            double scale) {
  std::vector<Se3> estimate;
  for (const Se3& T : reference) {
    estimate.emplace_back(R.inverse() * T.rotation(),
                          R.inverse() * ((T.translation() - t) / scale));
  }
  return estimate;
}

void expect_maps(const Alignment& alignment, const std::vector<Se3>& estimate,
                 const std::vector<Se3>& reference, double tolerance = kTolerance) {
  for (std::size_t i = 0; i < reference.size(); ++i) {
    EXPECT_LT((alignment * estimate[i].translation() - reference[i].translation()).norm(),
              tolerance);
  }
}

double angle_between(const So3& a, const So3& b) { return (a.inverse() * b).log().norm(); }

TEST(Alignment, RecoversAKnownRigidMotion) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const auto reference = random_poses(20, seed);
    const So3 R = random_poses(1, seed + 1000)[0].rotation();
    const auto estimate = moved_away(reference, R, {1.0, -2.0, 3.0}, 1.0);
    const Alignment alignment = align(AlignmentKind::kSe3, reference, estimate);
    EXPECT_LT(angle_between(alignment.R_reference_estimate, R), kTolerance) << seed;
    EXPECT_TRUE(alignment.rotation_determined);
    EXPECT_EQ(alignment.scale, 1.0);
    expect_maps(alignment, estimate, reference);
  }
}

TEST(Alignment, RecoversAKnownSimilarity) {
  const auto reference = random_poses(20, 3);
  const auto estimate = moved_away(reference, So3::exp({0.3, 2.0, -1.0}), {4.0, 5.0, 6.0}, 0.125);
  const Alignment alignment = align(AlignmentKind::kSim3, reference, estimate);
  EXPECT_NEAR(alignment.scale, 0.125, kTolerance);
  expect_maps(alignment, estimate, reference);
}

TEST(Alignment, ByYawRecoversAHeadingAndLeavesATiltAlone) {
  const auto reference = random_poses(20, 4);
  const auto estimate = moved_away(reference, So3::exp({0.0, 0.0, 2.5}), {4.0, 5.0, 6.0}, 1.0);
  expect_maps(align(AlignmentKind::kYaw, reference, estimate), estimate, reference);

  const auto tilted = moved_away(reference, So3::exp({0.2, 0.1, 2.5}), {4.0, 5.0, 6.0}, 1.0);
  const Vector3d rotation =
      align(AlignmentKind::kYaw, reference, tilted).R_reference_estimate.log();
  EXPECT_EQ(rotation.head<2>().norm(), 0.0);
}

TEST(Alignment, IsTheLeastSquaresFitUnderNoise) {
  const auto reference = random_poses(30, 5);
  auto estimate = moved_away(reference, So3::exp({0.3, -0.2, 1.0}), {1.0, 2.0, 3.0}, 2.0);
  Random random(9);
  for (Se3& T : estimate) {
    T = {T.rotation(),
         T.translation() + 0.1 * Vector3d(random.normal(), random.normal(), random.normal())};
  }
  const Alignment best = align(AlignmentKind::kSim3, reference, estimate);
  const auto cost = [&](const Alignment& a) {
    double sum = 0.0;
    for (std::size_t i = 0; i < reference.size(); ++i) {
      sum += (a * estimate[i].translation() - reference[i].translation()).squaredNorm();
    }
    return sum;
  };
  for (int direction = 0; direction < 7; ++direction) {
    for (const double step : {-1e-4, 1e-4}) {
      Alignment other = best;
      Vector3d delta = Vector3d::Zero();
      delta[direction % 3] = step;
      if (direction < 3) other.R_reference_estimate = best.R_reference_estimate * So3::exp(delta);
      if (direction >= 3 && direction < 6) other.t_reference_estimate += delta;
      if (direction == 6) other.scale += step;
      EXPECT_GT(cost(other), cost(best));
    }
  }
}

TEST(Alignment, NeverMirrors) {
  auto reference = random_poses(10, 6);
  std::vector<Se3> estimate;
  for (const Se3& T : reference)
    estimate.emplace_back(T.rotation(), T.translation().cwiseProduct(Vector3d(1, 1, -1)));
  const Alignment alignment = align(AlignmentKind::kSe3, reference, estimate);
  EXPECT_NEAR(alignment.R_reference_estimate.matrix().determinant(), 1.0, kTolerance);
}

TEST(Alignment, OfPlanarTrajectoriesNeverFlipsThePlane) {
  // Mirrored in the plane: in space half a turn about x would fit exactly, in the plane nothing
  // does.
  std::vector<Se3> reference, estimate;
  for (const Se3& T : random_poses(10, 7)) {
    const Vector3d p = T.translation();
    reference.emplace_back(So3(), Vector3d(p.x(), p.y(), 0.0));
    estimate.emplace_back(So3(), Vector3d(p.x(), -p.y(), 0.0));
  }
  const Alignment alignment = align(AlignmentKind::kSe3, reference, estimate, true);
  EXPECT_EQ(alignment.R_reference_estimate.log().head<2>().norm(), 0.0);
}

TEST(Alignment, OfCollinearPositionsTakesTheSmallestRotationAndSaysSo) {
  std::vector<Se3> reference, estimate;
  for (int i = 0; i < 5; ++i) {
    reference.emplace_back(So3(), Vector3d(0.0, 2.0 * i, 1.0));
    estimate.emplace_back(So3(), Vector3d(2.0 * i, 0.0, 0.0));
  }
  const Alignment alignment = align(AlignmentKind::kSe3, reference, estimate);
  EXPECT_FALSE(alignment.rotation_determined);
  expect_maps(alignment, estimate, reference);
  EXPECT_NEAR(alignment.R_reference_estimate.log().norm(), 0.5 * std::numbers::pi, kTolerance);
}

TEST(Alignment, OfTwoPosesFitsBothExactly) {
  const auto reference = random_poses(2, 8);
  const auto estimate = moved_away(reference, So3::exp({1.0, 0.5, -0.2}), {1.0, 1.0, 1.0}, 1.0);
  const Alignment alignment = align(AlignmentKind::kSe3, reference, estimate);
  EXPECT_FALSE(alignment.rotation_determined);
  expect_maps(alignment, estimate, reference);
}

TEST(Alignment, OfOnePointOrARobotThatStoodStillOnlyTranslates) {
  const std::vector<Se3> reference(3, Se3(So3(), Vector3d(1.0, 2.0, 3.0)));
  const std::vector<Se3> estimate(3, Se3(So3(), Vector3d(0.0, 1.0, 1.0)));
  for (const AlignmentKind kind :
       {AlignmentKind::kSe3, AlignmentKind::kSim3, AlignmentKind::kYaw}) {
    const Alignment alignment = align(kind, reference, estimate);
    EXPECT_FALSE(alignment.rotation_determined);
    EXPECT_EQ(alignment.scale, 1.0);
    expect_maps(alignment, estimate, reference);
  }
}

TEST(Alignment, KindNoneMovesNothing) {
  const auto reference = random_poses(3, 1), estimate = random_poses(3, 2);
  expect_maps(align(AlignmentKind::kNone, reference, estimate), estimate, estimate, 1e-15);
}

}  // namespace
}  // namespace cairn
