// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>

namespace cairn {

enum class VariableType : std::uint8_t { kPose2, kPose3, kPoint2, kPoint3 };

/// Dimension of the tangent space: 3, 6, 2, 3.
constexpr int tangent_dimension(VariableType type) {
  constexpr int kDimensions[] = {3, 6, 2, 3};
  return kDimensions[static_cast<int>(type)];
}
constexpr bool is_pose(VariableType type) {
  return type == VariableType::kPose2 || type == VariableType::kPose3;
}
std::string_view to_string(VariableType type);

/// Where a relative factor comes from. Set by the sender; for files by classify_factor_kinds().
enum class FactorKind : std::uint8_t { kOdometry, kLoop, kOther };

}  // namespace cairn
