// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/simulated/simulated_drive.hpp"

#include <algorithm>
#include <cmath>

#include "cairn/core/check.hpp"
#include "datasets/random.hpp"
#include "frontends/simulated/ray_caster.hpp"
#include "frontends/simulated/turn.hpp"

namespace cairn {
namespace {

constexpr int kStepsPerScan = 5;
constexpr double kReachedM = 0.15, kMostSeconds = 3600.0;
enum Stream : std::uint64_t { kWheels = 1, kLaser = 2 };

double rounded(double value, double digits) { return std::round(value * digits) / digits; }

struct Pose {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double theta_rad = 0.0;

  // Along an arc, by its chord.
  void move(double ahead_m, double turn_rad) {
    position += ahead_m * heading(theta_rad + 0.5 * turn_rad);
    theta_rad = wrap_angle(theta_rad + turn_rad);
  }
};

struct Motion {
  double ahead_m = 0.0, turn_rad = 0.0;
};

// Steers to one corner of the tour after the other: turns towards it, slows down before it.
class Driver {
 public:
  explicit Driver(const DriveOptions& options) : options_(options) {
    CAIRN_CHECK(!options.plan.tour.empty(), "a drive needs a tour");
    pose_.position = options.plan.tour.front();
  }

  [[nodiscard]] const Pose& pose() const { return pose_; }
  [[nodiscard]] bool arrived() const { return next_ >= options_.plan.tour.size(); }

  Motion drive_until_next_scan() {
    Motion total;
    for (int i = 0; i < kStepsPerScan; ++i) {
      while (!arrived() && (options_.plan.tour[next_] - pose_.position).norm() < kReachedM) ++next_;
      if (arrived()) break;
      const Motion step = next_step(options_.period_s / kStepsPerScan);
      pose_.move(step.ahead_m, step.turn_rad);
      total.ahead_m += step.ahead_m;
      total.turn_rad += step.turn_rad;
    }
    return total;
  }

 private:
  Motion next_step(double dt_s) {
    constexpr double kSlowM = 0.25, kGain = 3.0, kAcceleration = 1.5;
    const Eigen::Vector2d to_corner = options_.plan.tour[next_] - pose_.position;
    const double distance = to_corner.norm();
    const Eigen::Vector2d ahead = heading(pose_.theta_rad);
    const double cosine = ahead.dot(to_corner) / distance;
    const double sine = (ahead.x() * to_corner.y() - ahead.y() * to_corner.x()) / distance;
    const double most = options_.turn_rad_s;
    const double turn =
        cosine > 0.2 ? std::clamp(kGain * sine, -most, most) : std::copysign(most, sine);
    const double facing = std::max(0.0, cosine);
    const double wanted =
        std::min(options_.speed_m_s, kSlowM + distance) * (facing * facing) * (facing * facing);
    speed_m_s_ = std::min(wanted, speed_m_s_ + kAcceleration * dt_s);
    return {speed_m_s_ * dt_s, turn * dt_s};
  }

  const DriveOptions& options_;
  Pose pose_;
  double speed_m_s_ = 0.0;
  std::size_t next_ = 1;
};

class Wheels {
 public:
  Wheels(const WheelNoise& noise, std::uint64_t seed)
      : noise_(noise),
        random_(seed, kWheels),
        length_scale_(1.0 + noise.length_scale * random_.normal()),
        turn_scale_(1.0 + noise.turn_scale * random_.normal()),
        drift_rad_m_(noise.drift_rad_m * random_.normal()) {}

  void roll(const Motion& truth) {
    double ahead = truth.ahead_m * length_scale_ +
                   noise_.length_m * std::sqrt(truth.ahead_m) * random_.normal();
    double turn =
        truth.turn_rad * turn_scale_ + drift_rad_m_ * truth.ahead_m +
        noise_.turn_rad * std::sqrt(std::abs(truth.turn_rad) + truth.ahead_m) * random_.normal();
    if (random_.chance(noise_.slips_per_m * truth.ahead_m)) {
      ahead += noise_.slip_m * std::abs(random_.normal());
      turn += noise_.slip_rad * random_.normal();
    }
    pose_.move(ahead, turn);
  }
  [[nodiscard]] Se2 T_odom_body() const {
    return {rounded(pose_.position.x(), 1e6), rounded(pose_.position.y(), 1e6),
            rounded(pose_.theta_rad, 1e6)};
  }

 private:
  WheelNoise noise_;
  Random random_;
  double length_scale_, turn_scale_, drift_rad_m_;
  Pose pose_;
};

// Distance to a disc; nothing from inside.
std::optional<double> meet_disc(const Eigen::Vector2d& center, double radius_m,
                                const Eigen::Vector2d& origin, const Eigen::Vector2d& direction) {
  const Eigen::Vector2d to_center = center - origin;
  const double along = to_center.dot(direction);
  const double square = along * along - to_center.squaredNorm() + radius_m * radius_m;
  if (square < 0.0 || to_center.norm() <= radius_m || along < 0.0) return std::nullopt;
  return along - std::sqrt(square);
}

class Laser {
 public:
  Laser(const SimulatedLaser& laser, const FloorPlan& plan, std::uint64_t seed)
      : laser_(laser), plan_(plan), caster_(plan.walls), random_(seed, kLaser) {}

  LaserScan scan(const Pose& pose, double time_s) {
    LaserScan scan{.first_angle_rad = laser_.first_angle_rad,
                   .angle_step_rad = laser_.angle_step_rad,
                   .max_range_m = laser_.max_range_m,
                   .ranges_m = {}};
    people_.clear();
    for (const Walker& walker : plan_.walkers) people_.push_back(position_of(walker, time_s));
    for (std::size_t i = 0; i < laser_.beams; ++i) {
      const double angle = laser_.first_angle_rad + static_cast<double>(i) * laser_.angle_step_rad;
      scan.ranges_m.push_back(reading(pose.position, heading(pose.theta_rad + angle)));
    }
    return scan;
  }

 private:
  float reading(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction) {
    constexpr double kNearestM = 0.02;
    if (random_.chance(laser_.dropout)) return 0.0F;
    const double distance = nearest(origin, direction);
    if (distance >= laser_.max_range_m) return static_cast<float>(laser_.max_range_m);
    const double read = std::max(kNearestM, distance + laser_.sigma_m * random_.normal());
    return static_cast<float>(std::min(laser_.max_range_m, rounded(read, 1e3)));
  }

  double nearest(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction) {
    double least = laser_.max_range_m;
    for (std::size_t i = 0; i < people_.size(); ++i)
      if (const auto hit = meet_disc(people_[i], plan_.walkers[i].radius_m, origin, direction))
        least = std::min(least, *hit);
    auto hit = caster_.cast(origin, direction, least);
    while (hit && plan_.walls[hit->wall].glass && !random_.chance(laser_.glass_seen))
      hit = caster_.cast(origin, direction, least, hit->distance_m);
    return hit ? hit->distance_m : least;
  }

  SimulatedLaser laser_;
  const FloorPlan& plan_;
  RayCaster caster_;
  Random random_;
  std::vector<Eigen::Vector2d> people_;
};

}  // namespace

SimulatedDrive simulate_drive(const DriveOptions& options) {
  SimulatedDrive drive{.plan = options.plan};
  Driver driver(options);
  Wheels wheels(options.wheels, options.seed);
  Laser laser(options.laser, options.plan, options.seed);
  for (std::int64_t k = 0;; ++k) {
    const double time_s = static_cast<double>(k) * options.period_s;
    const Pose& pose = driver.pose();
    LaserScan scan = laser.scan(pose, time_s);
    scan.stamp_ns = std::llround(1e9 * time_s);
    scan.T_odom_laser = wheels.T_odom_body();
    drive.scans.push_back(std::move(scan));
    drive.truth.emplace_back(pose.position.x(), pose.position.y(), pose.theta_rad);
    if (driver.arrived() || time_s >= kMostSeconds) return drive;
    wheels.roll(driver.drive_until_next_scan());
  }
}

}  // namespace cairn
