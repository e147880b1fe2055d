// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "tests/support/matrix_matchers.hpp"
#include "tests/support/random.hpp"

namespace cairn::test {

/// Rotation angles where formulas change branch or lose digits, and ordinary ones.
inline std::vector<double> critical_angles() {
  return {0.0,
          1e-12,
          1e-9,
          9.9e-5,
          1e-4,
          1.01e-4,
          9.9e-3,
          1.01e-2,
          4.9e-2,
          5.1e-2,
          0.7,
          2.0,
          std::numbers::pi - 1e-6};
}

/// A random tangent vector whose rotation part has length `angle_rad`.
template <class Group>
typename Group::Tangent tangent_with_angle(Random& random, double angle_rad) {
  using Tangent = typename Group::Tangent;
  constexpr int kRows = Tangent::RowsAtCompileTime;
  Tangent v = random.vector<kRows>(3.0);
  if constexpr (std::is_same_v<Group, Se2>) {
    v[2] = random.coin() ? angle_rad : -angle_rad;
  } else {
    v.template tail<3>() = angle_rad * random.vector<3>().normalized();
  }
  return v;
}

template <class Group>
auto adjoint_of(const Group& T) {
  if constexpr (requires { T.adjoint(); }) {
    return T.adjoint();
  } else {
    return T.matrix();  // SO(3)
  }
}

/// Exp and Log undo each other. 2e-9 at pi - 1e-6, where the axis is known to eps / 1e-6 only;
/// 1e-12 elsewhere.
template <class Group>
void expect_exp_and_log_are_inverse(std::uint64_t seed) {
  Random random(seed);
  for (const double angle : critical_angles()) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", angle " + std::to_string(angle));
    const auto v = tangent_with_angle<Group>(random, angle);
    const Group T = Group::exp(v);
    const double tolerance = angle > 3.0 ? 2e-9 : 1e-12;
    EXPECT_THAT(T.log(), is_near(v, tolerance));
    EXPECT_THAT(homogeneous(Group::exp(T.log())), is_near(homogeneous(T), 1e-13));
  }
}

/// Identity, inverse and associativity, and Exp(s v) Exp(t v) = Exp((s + t) v).
template <class Group>
void expect_group_laws(std::uint64_t seed) {
  Random random(seed);
  for (const double angle : critical_angles()) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", angle " + std::to_string(angle));
    const auto v = tangent_with_angle<Group>(random, angle);
    const Group A = Group::exp(v), B = Group::exp(tangent_with_angle<Group>(random, 1.0)),
                C = Group::exp(tangent_with_angle<Group>(random, 2.0));
    EXPECT_THAT(homogeneous(A * A.inverse()), is_near(homogeneous(Group()), 1e-14));
    EXPECT_THAT(homogeneous(A * Group()), is_near(homogeneous(A), 1e-15));
    EXPECT_THAT(homogeneous((A * B) * C), is_near(homogeneous(A * (B * C)), 2e-14));
    EXPECT_THAT(homogeneous(A * B), is_near(homogeneous(A) * homogeneous(B), 2e-14));
    EXPECT_THAT(homogeneous(Group::exp(0.3 * v) * Group::exp(0.5 * v)),
                is_near(homogeneous(Group::exp(0.8 * v)), 1e-13));
  }
}

/// T Exp(d) = Exp(Ad_T d) T, and Ad_{AB} = Ad_A Ad_B.
template <class Group>
void expect_adjoint_moves_perturbations_to_the_left(std::uint64_t seed) {
  Random random(seed);
  for (const double angle : critical_angles()) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", angle " + std::to_string(angle));
    const Group T = Group::exp(tangent_with_angle<Group>(random, angle));
    const Group S = Group::exp(tangent_with_angle<Group>(random, 1.0));
    const typename Group::Tangent d = 0.1 * tangent_with_angle<Group>(random, 1.0);
    const typename Group::Tangent moved = adjoint_of(T) * d;
    EXPECT_THAT(homogeneous(T * Group::exp(d)), is_near(homogeneous(Group::exp(moved) * T), 1e-13));
    EXPECT_THAT(adjoint_of(T * S), is_near(adjoint_of(T) * adjoint_of(S), 1e-13));
  }
}

/// (T [+] d) [-] T = d, where A [-] B = Log(B^-1 A).
template <class Group>
void expect_retraction_is_undone(std::uint64_t seed) {
  Random random(seed);
  for (const double angle : critical_angles()) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", angle " + std::to_string(angle));
    const Group T = Group::exp(tangent_with_angle<Group>(random, 2.0));
    const auto d = tangent_with_angle<Group>(random, angle);
    EXPECT_THAT((T.inverse() * T.retract(d)).log(), is_near(d, angle > 3.0 ? 1e-8 : 1e-12));
  }
}

/// d Log(Exp(v) Exp(d)) / dd by differences of fourth order.
template <class Group>
void expect_right_jacobian_inverse_matches_differences(std::uint64_t seed) {
  constexpr int kDim = Group::Tangent::RowsAtCompileTime;
  using Matrix = Eigen::Matrix<double, kDim, kDim>;
  Random random(seed);
  for (const double angle : critical_angles()) {
    if (angle > 3.0) continue;  // a step would cross the cut of the logarithm
    SCOPED_TRACE("seed " + std::to_string(seed) + ", angle " + std::to_string(angle));
    const auto v = tangent_with_angle<Group>(random, angle);
    const double h = 1e-3;
    const auto log_at = [&](int axis, double step) -> typename Group::Tangent {
      return (Group::exp(v) * Group::exp(step * Group::Tangent::Unit(axis))).log();
    };
    Matrix numeric;
    for (int axis = 0; axis < kDim; ++axis) {
      numeric.col(axis) = (8.0 * (log_at(axis, h) - log_at(axis, -h)) -
                           (log_at(axis, 2.0 * h) - log_at(axis, -2.0 * h))) /
                          (12.0 * h);
    }
    EXPECT_THAT(Group::right_jacobian_inverse(v), is_near(numeric, 1e-10));
  }
}

}  // namespace cairn::test
