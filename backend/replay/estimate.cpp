// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/replay/estimate.hpp"

#include <algorithm>
#include <cmath>

#include "cairn/factors/between.hpp"
#include "cairn/factors/factor_codec.hpp"

namespace cairn {
namespace {

Se2 pose2(const double* x) { return {x[0], x[1], x[2]}; }
Se3 pose3(const double* x) {
  return {So3(Eigen::Quaterniond(x[6], x[3], x[4], x[5])), Eigen::Vector3d(x[0], x[1], x[2])};
}
Estimate estimate_of(const Se2& T) { return {T.x(), T.y(), T.theta()}; }
Estimate estimate_of(const Se3& T) {
  const Eigen::Vector3d& t = T.translation();
  const Eigen::Quaterniond q = T.rotation().quaternion().normalized();
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

template <class Pose>
Estimate composed(const Pose& T_map_known, const Pose& T_a_b, bool forward) {
  return estimate_of(T_map_known * (forward ? T_a_b : T_a_b.inverse()));
}

}  // namespace

Estimate to_estimate(std::span<const double> numbers) {
  Estimate estimate{};
  std::copy_n(numbers.begin(), std::min(numbers.size(), estimate.size()), estimate.begin());
  return estimate;
}

std::optional<Estimate> compose(const Estimate& known, FactorType type,
                                std::span<const double> numbers, bool forward) {
  const FactorTypeInfo* info = find_factor_type(type);
  if (info->name == BetweenSe2::kName)
    return composed(pose2(known.data()), pose2(numbers.data()), forward);
  if (info->name == BetweenSe3::kName)
    return composed(pose3(known.data()), pose3(numbers.data()), forward);
  return std::nullopt;
}

Estimate product(VariableType type, const Estimate& T_a_b, const Estimate& T_b_c) {
  return type == VariableType::kPose2 ? composed(pose2(T_a_b.data()), pose2(T_b_c.data()), true)
                                      : composed(pose3(T_a_b.data()), pose3(T_b_c.data()), true);
}

Estimate map_from_odometry(VariableType type, const Estimate& T_map_body,
                           const Estimate& T_odom_body) {
  return type == VariableType::kPose2
             ? composed(pose2(T_map_body.data()), pose2(T_odom_body.data()), false)
             : composed(pose3(T_map_body.data()), pose3(T_odom_body.data()), false);
}

PoseDistance distance(VariableType type, const Estimate& a, const Estimate& b) {
  if (type == VariableType::kPose2) {
    const Se2 between = pose2(a.data()).inverse() * pose2(b.data());
    return {between.translation().norm(), std::abs(between.theta())};
  }
  const Se3 between = pose3(a.data()).inverse() * pose3(b.data());
  return {between.translation().norm(), between.rotation().log().norm()};
}

}  // namespace cairn
