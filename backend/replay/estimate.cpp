// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/replay/estimate.hpp"

#include <algorithm>

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

std::optional<Estimate> compose(const Estimate& known, const NewFactor& factor, bool forward) {
  const FactorTypeInfo* info = find_factor_type(factor.type);
  const double* measured = factor.numbers.data();
  if (info->name == BetweenSe2::kName)
    return composed(pose2(known.data()), pose2(measured), forward);
  if (info->name == BetweenSe3::kName)
    return composed(pose3(known.data()), pose3(measured), forward);
  return std::nullopt;
}

}  // namespace cairn
