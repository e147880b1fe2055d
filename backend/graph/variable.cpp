// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/graph/variable.hpp"

namespace cairn {

std::string_view to_string(VariableType type) {
  constexpr std::string_view kNames[] = {"SE(2) pose", "SE(3) pose", "2-D point", "3-D point"};
  return kNames[static_cast<int>(type)];
}

void Values::retract(VariableType type, std::uint32_t index, const double* delta) {
  switch (type) {
    case VariableType::kPose2:
      pose2[index] = pose2[index].retract(Eigen::Map<const Eigen::Vector3d>(delta));
      break;
    case VariableType::kPose3:
      pose3[index] = pose3[index].retract(Eigen::Map<const Se3::Tangent>(delta));
      break;
    case VariableType::kPoint2:
      point2[index] += Eigen::Map<const Eigen::Vector2d>(delta);
      break;
    case VariableType::kPoint3:
      point3[index] += Eigen::Map<const Eigen::Vector3d>(delta);
      break;
  }
}

}  // namespace cairn
