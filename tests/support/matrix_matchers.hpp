// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gmock/gmock.h>

#include <Eigen/Core>
#include <sstream>

#include "cairn/geometry/se2.hpp"
#include "cairn/geometry/se3.hpp"

namespace cairn::test {

inline std::string matrix_text(const Eigen::MatrixXd& m) {
  std::ostringstream out;
  out << '\n' << m.format(Eigen::IOFormat(12));
  return out.str();
}

MATCHER_P2(MatrixNear, expected, tolerance,
           "within " + testing::PrintToString(tolerance) + " of" + matrix_text(expected)) {
  const Eigen::MatrixXd actual = arg;
  if (actual.rows() != expected.rows() || actual.cols() != expected.cols()) {
    *result_listener << "its size is " << actual.rows() << " x " << actual.cols();
    return false;
  }
  const double gap = actual.size() == 0 ? 0.0 : (actual - expected).cwiseAbs().maxCoeff();
  *result_listener << "the largest gap is " << gap << " in" << matrix_text(actual);
  return gap <= tolerance;  // false for NaN
}

/// EXPECT_THAT(actual, is_near(expected, 1e-12)): every coefficient within `tolerance`, both
/// matrices printed.
template <class Derived>
auto is_near(const Eigen::MatrixBase<Derived>& expected, double tolerance) {
  return MatrixNear(Eigen::MatrixXd(expected), tolerance);
}

/// 3 x 3 and 4 x 4 homogeneous matrices: compares poses without a chart.
inline Eigen::Matrix3d homogeneous(const Se2& T) {
  Eigen::Matrix3d M = Eigen::Matrix3d::Identity();
  M.topLeftCorner<2, 2>() = T.rotation().matrix();
  M.topRightCorner<2, 1>() = T.translation();
  return M;
}
inline Eigen::Matrix4d homogeneous(const Se3& T) {
  Eigen::Matrix4d M = Eigen::Matrix4d::Identity();
  M.topLeftCorner<3, 3>() = T.rotation().matrix();
  M.topRightCorner<3, 1>() = T.translation();
  return M;
}
inline Eigen::Matrix3d homogeneous(const So3& R) { return R.matrix(); }

}  // namespace cairn::test
