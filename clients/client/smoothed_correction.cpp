// SPDX-License-Identifier: BSD-3-Clause
#include "clients/client/smoothed_correction.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "cairn/geometry/se2.hpp"
#include "cairn/geometry/se3.hpp"

namespace cairn {
namespace {

template <class Pose>
Pose pose_of(const PoseNumbers& x) {
  if constexpr (std::is_same_v<Pose, Se2>) {
    return {x[0], x[1], x[2]};
  } else {
    return {So3(Eigen::Quaterniond(x[6], x[3], x[4], x[5])), Eigen::Vector3d(x[0], x[1], x[2])};
  }
}

PoseNumbers numbers_of(const Se2& T) { return {T.x(), T.y(), T.theta()}; }
PoseNumbers numbers_of(const Se3& T) {
  const Eigen::Vector3d& t = T.translation();
  const Eigen::Quaterniond q = T.rotation().quaternion().normalized();
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

Se2 part_of(const Se2& T, double fraction) {
  const Eigen::Vector2d t = fraction * T.translation();
  return {t.x(), t.y(), fraction * T.theta()};
}
Se3 part_of(const Se3& T, double fraction) {
  return {So3::exp(fraction * T.rotation().log()), fraction * T.translation()};
}

double angle_of(const Se2& T) { return std::abs(T.theta()); }
double angle_of(const Se3& T) { return T.rotation().log().norm(); }

// Towards `target` so far that the body moves by at most so much.
template <class Pose>
PoseNumbers step(const PoseNumbers& now, const PoseNumbers& target, const PoseNumbers& T_odom_body,
                 double most_m, double most_rad) {
  const Pose body = pose_of<Pose>(T_odom_body);
  const Pose T_map_body = pose_of<Pose>(now) * body;
  const Pose way = T_map_body.inverse() * (pose_of<Pose>(target) * body);
  const double distance = way.translation().norm(), angle = angle_of(way);
  if (distance <= most_m && angle <= most_rad) return target;
  const double fraction = std::min(distance > most_m ? most_m / distance : 1.0,
                                   angle > most_rad ? most_rad / angle : 1.0);
  return numbers_of(T_map_body * part_of(way, fraction) * body.inverse());
}

}  // namespace

void SmoothedCorrection::take(const Correction& correction) {
  const bool goes_on =
      target_ && target_->frame == correction.frame && target_->map == correction.map;
  if (!goes_on) now_ = correction.T_map_odom;
  target_ = correction;
}

std::optional<PoseNumbers> SmoothedCorrection::T_map_odom(std::int64_t now_ns,
                                                          const PoseNumbers& T_odom_body) {
  if (!target_) return std::nullopt;
  const std::int64_t before = std::exchange(asked_ns_, now_ns).value_or(now_ns);
  const double seconds = 1e-9 * static_cast<double>(std::max<std::int64_t>(now_ns - before, 0));
  const auto move = target_->type == VariableType::kPose2 ? step<Se2> : step<Se3>;
  now_ = move(now_, target_->T_map_odom, T_odom_body, rate_.m_per_s * seconds,
              rate_.rad_per_s * seconds);
  return now_;
}

bool SmoothedCorrection::settled() const { return target_ && now_ == target_->T_map_odom; }

}  // namespace cairn
