// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "cairn/geometry/se2.hpp"
#include "cairn/geometry/se3.hpp"
#include "cairn/graph/variable.hpp"

namespace cairn::test {

/// Random test input from an explicit seed, the same on every platform (only the engine of <random>
/// is used).
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed), seed_(seed) {}
  [[nodiscard]] std::uint64_t seed() const { return seed_; }

  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  double normal() {  // Box-Muller
    return std::sqrt(-2.0 * std::log(1.0 - uniform(0.0, 1.0))) * std::cos(angle());
  }
  double angle() { return uniform(-std::numbers::pi, std::numbers::pi); }
  bool coin() { return uniform(0.0, 1.0) < 0.5; }
  std::size_t index(std::size_t count) { return engine_() % count; }

  template <int kDim>
  Eigen::Matrix<double, kDim, 1> vector(double scale = 1.0) {
    Eigen::Matrix<double, kDim, 1> v;
    for (int i = 0; i < kDim; ++i) v[i] = scale * normal();
    return v;
  }
  /// Uniform over all rotations.
  So3 rotation3() {
    const Eigen::Vector4d q = vector<4>().normalized();
    return So3(Eigen::Quaterniond(q[3], q[0], q[1], q[2]));
  }
  Se2 pose2(double scale_m = 10.0) {
    const Eigen::Vector2d t = vector<2>(scale_m);
    return {t.x(), t.y(), angle()};
  }
  Se3 pose3(double scale_m = 10.0) {
    const So3 R = rotation3();
    return {R, vector<3>(scale_m)};
  }
  /// Symmetric, full (no zero off the diagonal), eigenvalues of order one, at least 0.1.
  template <int kDim>
  Eigen::Matrix<double, kDim, kDim> information() {
    Eigen::Matrix<double, kDim, kDim> A;
    for (int i = 0; i < kDim; ++i) A.col(i) = vector<kDim>();
    const Eigen::Matrix<double, kDim, kDim> Omega = A * A.transpose() / kDim;
    return Omega + 0.1 * Eigen::Matrix<double, kDim, kDim>::Identity();
  }

 private:
  std::mt19937_64 engine_;
  std::uint64_t seed_;
};

/// Appends a random variable of the type to `values` and returns its index.
inline std::uint32_t append_random_variable(VariableType type, Random& random, Values& values) {
  const auto append = [](auto& array, const auto& value) {
    array.push_back(value);
    return static_cast<std::uint32_t>(array.size() - 1);
  };
  switch (type) {
    case VariableType::kPose2:
      return append(values.pose2, random.pose2());
    case VariableType::kPose3:
      return append(values.pose3, random.pose3());
    case VariableType::kPoint2:
      return append(values.point2, random.vector<2>(10.0));
    case VariableType::kPoint3:
      return append(values.point3, random.vector<3>(10.0));
  }
  return 0;
}

}  // namespace cairn::test
