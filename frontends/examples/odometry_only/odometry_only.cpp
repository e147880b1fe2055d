// SPDX-License-Identifier: BSD-3-Clause
// A front-end as a shared object: keyframes where wheel odometry says they are. Scans are kept, so
// that the daemon renders them, but not matched: it shows what matching is worth.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cairn/factors/build_transaction.hpp"
#include "cairn/maps/range_scan.hpp"
#include "frontends/api/frontend.hpp"

namespace {

constexpr double kKeyframeM = 0.5, kKeyframeRad = 0.5;
// Sigmas of a step: at least, and per m and rad of it.
constexpr double kLeastM = 0.01, kLeastRad = 0.005, kPerM = 0.05, kPerRad = 0.05;

Eigen::Matrix3d information_of(const cairn::Se2& step) {
  const double way_m = step.translation().norm(), turn_rad = std::abs(step.theta());
  const double m = kLeastM + kPerM * way_m, rad = kLeastRad + kPerM * way_m + kPerRad * turn_rad;
  return Eigen::Vector3d(1.0 / (m * m), 1.0 / (m * m), 1.0 / (rad * rad)).asDiagonal();
}

class OdometryOnly final : public cairn::Frontend {
 public:
  cairn::Result<void> start(cairn::FrontendContext& context) override {
    context_ = &context;
    return {};
  }

  cairn::Result<void> process(const cairn::SensorFrame& frame) override {
    const auto& scan = std::get<cairn::LaserScan>(frame);
    follow(scan.T_odom_laser);
    cairn::Se2 step = T_odom_keyframe_.inverse() * T_odom_laser_;
    if (keyframes_ == 0 || step.translation().norm() >= kKeyframeM ||
        std::abs(step.theta()) >= kKeyframeRad) {
      if (auto added = add_keyframe(scan, step); !added) return added;
      step = cairn::Se2();
    }
    context_->localize({scan.stamp_ns, node(keyframes_ - 1), step});
    return {};
  }

  // Nothing here depends on the map.
  void on_snapshot(const cairn::MapSnapshot& /*snapshot*/) override {}
  cairn::Result<void> stop() override { return {}; }

 private:
  // Steps, and not places: odometry may come late, or be away for a while.
  void follow(const std::optional<cairn::Se2>& wheel) {
    if (!wheel) return;
    if (wheel_)
      T_odom_laser_ = T_odom_laser_ * (wheel_->inverse() * *wheel);
    else if (keyframes_ == 0)
      T_odom_laser_ = *wheel;
    wheel_ = wheel;
  }

  [[nodiscard]] cairn::NodeId node(std::uint64_t keyframe) const {
    return {{context_->robot(), context_->epoch()}, keyframe};
  }

  cairn::Result<void> add_keyframe(const cairn::LaserScan& scan, const cairn::Se2& step) {
    const std::uint64_t newest = keyframes_++;
    T_odom_keyframe_ = T_odom_laser_;
    // A run before this one has sent it; but the second keyframe names the first scan, too.
    const std::uint64_t before = context_->keyframes_before();
    const bool named_later = newest == 0 && before == 1;
    if (newest < before && !named_later) return {};
    if (auto sent = send_scan(scan); !sent) return sent;
    if (newest < before) return {};
    cairn::Transaction transaction;
    cairn::add_pose(transaction, node(newest), T_odom_laser_, scan.stamp_ns);
    transaction.variables.back().odometry = transaction.variables.back().start;
    if (newest > 0) {
      cairn::add_between(transaction, node(newest - 1), node(newest), step, information_of(step));
      transaction.factors.back().payloads = std::exchange(unnamed_, {});
    }
    return context_->submit_keyframe(std::move(transaction));
  }

  cairn::Result<void> send_scan(const cairn::LaserScan& scan) {
    const auto bytes = cairn::encode(cairn::RangeScan{.first_angle_rad = scan.first_angle_rad,
                                                      .angle_step_rad = scan.angle_step_rad,
                                                      .max_range_m = scan.max_range_m,
                                                      .T_body_laser = cairn::Se2(),
                                                      .ranges_m = scan.ranges_m});
    if (!bytes) return bytes.error();
    const auto hash = context_->send_payload(std::string(cairn::kRangeScanPayload), *bytes);
    if (!hash) return hash.error();
    unnamed_.push_back(*hash);
    return {};
  }

  cairn::FrontendContext* context_ = nullptr;
  std::optional<cairn::Se2> wheel_;  // where odometry said last that the laser was
  cairn::Se2 T_odom_laser_, T_odom_keyframe_;
  std::uint64_t keyframes_ = 0;
  std::vector<cairn::ContentHash> unnamed_;  // scans that no factor has named so far
};

}  // namespace

extern "C" __attribute__((visibility("default"))) const cairn::FrontendPlugin cairn_frontend_plugin{
    cairn::FrontendPlugin::kVersion, "odometry_only",
    [] { return static_cast<cairn::Frontend*>(new OdometryOnly); }};
