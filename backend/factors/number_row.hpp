// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cairn/factors/factor_codec.hpp"
#include "cairn/factors/sensor_offset.hpp"
#include "cairn/geometry/se2.hpp"
#include "cairn/geometry/se3.hpp"

/// For the codecs only: measurements and values as rows of numbers.
namespace cairn {

/// Appends numbers.
struct NumberWriter {
  std::vector<double>& numbers;

  void operator()(double x) { numbers.push_back(x); }
  template <int N>
  void operator()(const Eigen::Matrix<double, N, 1>& v) {
    numbers.insert(numbers.end(), v.data(), v.data() + N);
  }
  void operator()(const Se2& T) { (*this)(T.to_vector()); }
  void operator()(const Se3& T) {
    (*this)(T.translation());
    const Eigen::Vector4d q = T.rotation().quaternion().coeffs();
    (*this)(Eigen::Vector4d(q.w() < 0.0 ? Eigen::Vector4d(-q) : q));
  }
  template <class Pose>
  void operator()(const SensorOffset<Pose>& sensor) {
    (*this)(sensor.T_body_sensor);
  }
};

/// Takes them back, in the same order.
struct NumberReader {
  const double* next;
  bool unit_quaternions = true;

  void operator()(double& x) { x = *next++; }
  template <int N>
  void operator()(Eigen::Matrix<double, N, 1>& v) {
    v = Eigen::Map<const Eigen::Matrix<double, N, 1>>(next);
    next += N;
  }
  void operator()(Se2& T) {
    T = Se2(next[0], next[1], next[2]);
    next += 3;
  }
  void operator()(Se3& T) {
    const Eigen::Map<const Eigen::Vector4d> q(next + 3);
    unit_quaternions = unit_quaternions && std::abs(q.norm() - 1.0) <= 1e-3;
    if (unit_quaternions)
      T = Se3(So3(Eigen::Quaterniond(q)), Eigen::Map<const Eigen::Vector3d>(next));
    next += 7;
  }
  template <class Pose>
  void operator()(SensorOffset<Pose>& sensor) {
    (*this)(sensor.T_body_sensor);
  }
};

inline constexpr const char* kNotUnit = "a quaternion is not of unit length (1e-3)";

inline bool all_finite(std::span<const double> numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

inline std::string count_fault(std::string_view name, std::size_t expected, const char* what,
                               std::size_t found) {
  return std::string(name) + " expects " + std::to_string(expected) + ' ' + what + ", found " +
         std::to_string(found);
}

inline FactorFault not_finite(std::string_view name) {
  return {RefusalCode::kNotFinite, std::string(name) + " holds a number that is not finite"};
}

}  // namespace cairn
