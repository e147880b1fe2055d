// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/geometry/information.hpp"

#include "tests/support/matrix_matchers.hpp"
#include "tests/support/random.hpp"

namespace cairn::test {
namespace {

TEST(Information, SquareRootReproducesAFullMatrix) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Matrix<double, 6, 6> Omega = random.information<6>();
    const Eigen::Matrix<double, 6, 6> U = sqrt_information<6>(Omega);
    EXPECT_THAT(U.transpose() * U, is_near(Omega, 1e-13));
    const Eigen::Matrix<double, 6, 1> e = random.vector<6>();
    // The wrong factor, L instead of L^T, passes for diagonal matrices only.
    EXPECT_NEAR((U * e).squaredNorm(), e.dot(Omega * e), 1e-12);
  }
}

TEST(Information, SquareRootOfADefiniteMatrixIsUpperTriangular) {
  Random random(3);
  const Eigen::Matrix3d U = sqrt_information<3>(random.information<3>());
  EXPECT_TRUE(U.isUpperTriangular(0.0));
}

TEST(Information, SquareRootAcceptsSemidefiniteMatrices) {
  Random random(4);
  for (int rank = 0; rank < 6; ++rank) {
    Eigen::Matrix<double, 6, 6> Omega = Eigen::Matrix<double, 6, 6>::Zero();
    for (int i = 0; i < rank; ++i) {
      const Eigen::Matrix<double, 6, 1> v = random.vector<6>();
      Omega += v * v.transpose();
    }
    EXPECT_TRUE(is_positive_semidefinite<6>(Omega)) << "rank " << rank;
    const Eigen::Matrix<double, 6, 6> U = sqrt_information<6>(Omega);
    EXPECT_THAT(U.transpose() * U, is_near(Omega, 1e-12)) << "rank " << rank;
  }
}

TEST(Information, IndefiniteMatricesAreRecognized) {
  EXPECT_FALSE(is_positive_semidefinite<2>(Eigen::Matrix2d{{1.0, 2.0}, {2.0, 1.0}}));
  EXPECT_FALSE(is_positive_semidefinite<1>(Eigen::Matrix<double, 1, 1>(-1.0)));
  EXPECT_TRUE(is_positive_semidefinite<2>(Eigen::Matrix2d{{1.0, 1.0}, {1.0, 1.0}}));
  EXPECT_TRUE(is_positive_semidefinite<1>(Eigen::Matrix<double, 1, 1>(0.0)));
}

TEST(Information, FromSigmasIsTheInverseVariance) {
  EXPECT_THAT(information_from_sigmas<2>({0.5, 0.1}),
              is_near(Eigen::Matrix2d{{4.0, 0.0}, {0.0, 100.0}}, 1e-12));
}

}  // namespace
}  // namespace cairn::test
