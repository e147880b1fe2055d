// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "cairn/graph/pose_graph.hpp"

/// Poses as the numbers of NewVariable::start.
namespace cairn {

Estimate to_estimate(std::span<const double> numbers);

/// The pose at the other end of a measured relative pose: behind it (`forward`) or before it.
/// Nothing where the factor measures no relative pose.
std::optional<Estimate> compose(const Estimate& known, FactorType type,
                                std::span<const double> numbers, bool forward);

/// T_a_c = T_a_b * T_b_c.
Estimate product(VariableType type, const Estimate& T_a_b, const Estimate& T_b_c);
/// T_map_odom = T_map_body * T_odom_body^-1.
Estimate map_from_odometry(VariableType type, const Estimate& T_map_body,
                           const Estimate& T_odom_body);

/// How far apart two poses are.
struct PoseDistance {
  double translation_m = 0.0;
  double rotation_rad = 0.0;
};
PoseDistance distance(VariableType type, const Estimate& a, const Estimate& b);

}  // namespace cairn
