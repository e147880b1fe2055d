// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "cairn/core/ids.hpp"
#include "cairn/geometry/se2.hpp"
#include "cairn/geometry/se3.hpp"
#include "cairn/graph/kinds.hpp"

namespace cairn {

/// One variable of a graph. Its value is values().<type>[index].
struct Variable {
  VariableId id;
  VariableType type;
  std::uint32_t index;
  bool fixed = false;
};

/// All estimates, one contiguous array per type. Poses are T_map_body, points p_map.
struct Values {
  std::vector<Se2> pose2;
  std::vector<Se3> pose3;
  std::vector<Eigen::Vector2d> point2;
  std::vector<Eigen::Vector3d> point3;

  /// The variable [+] delta; delta has tangent_dimension(type) numbers.
  void retract(VariableType type, std::uint32_t index, const double* delta);
};

/// The value type behind each VariableType, and the array it lives in.
template <VariableType kType>
struct VariableTraits;
template <>
struct VariableTraits<VariableType::kPose2> {
  using Value = Se2;
  static constexpr auto kArray = &Values::pose2;
};
template <>
struct VariableTraits<VariableType::kPose3> {
  using Value = Se3;
  static constexpr auto kArray = &Values::pose3;
};
template <>
struct VariableTraits<VariableType::kPoint2> {
  using Value = Eigen::Vector2d;
  static constexpr auto kArray = &Values::point2;
};
template <>
struct VariableTraits<VariableType::kPoint3> {
  using Value = Eigen::Vector3d;
  static constexpr auto kArray = &Values::point3;
};

inline Se2 retract(const Se2& T, const Eigen::Vector3d& delta) { return T.retract(delta); }
inline Se3 retract(const Se3& T, const Se3::Tangent& delta) { return T.retract(delta); }
inline Eigen::Vector2d retract(const Eigen::Vector2d& p, const Eigen::Vector2d& delta) {
  return p + delta;
}
inline Eigen::Vector3d retract(const Eigen::Vector3d& p, const Eigen::Vector3d& delta) {
  return p + delta;
}

}  // namespace cairn
