// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "cairn/geometry/se2.hpp"
#include "cairn/graph/transaction.hpp"

namespace cairn::test {

/// What a robot on a ring road sends, step by step: the same for the same seed, robot and step.
/// First it drives lap after lap, a pose a step; then it drives on where it has been and adds no
/// poses, only loop closures. Some closures are false: places that look alike and are not.
class Course {
 public:
  static constexpr std::array<const char*, 3> kRobots{"kestrel", "merlin", "osprey"};
  static constexpr std::uint64_t kLap = 60;  ///< poses, one meter apart

  struct Step {
    Transaction transaction;
    std::optional<std::uint32_t> false_factor{};  ///< its place
  };

  Course(std::uint64_t seed, std::size_t robot, std::uint64_t poses)
      : seed_(seed), robot_(robot), poses_(poses) {}

  Step step(std::uint64_t i) {
    std::seed_seq names{seed_, static_cast<std::uint64_t>(robot_), i};
    Random random(names);
    return i < poses_ ? drive(i, random) : revisit(random);
  }

 private:
  using Random = std::mt19937_64;
  struct Sigmas {
    double m, rad;
  };
  static constexpr Sigmas kOdometry{0.02, 0.005}, kLoop{0.05, 0.01};

  static std::uint64_t draw(Random& random, std::uint64_t first, std::uint64_t last) {
    return std::uniform_int_distribution<std::uint64_t>(first, last)(random);
  }
  static double uniform(Random& random, double most) {
    return std::uniform_real_distribution<double>(-most, most)(random);
  }
  // Robots begin a third of a lap apart.
  static std::uint64_t place(std::size_t robot, std::uint64_t i) { return i + robot * kLap / 3; }
  static Se2 truth(std::size_t robot, std::uint64_t i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(place(robot, i) % kLap) /
                         static_cast<double>(kLap);
    const double radius = static_cast<double>(kLap) / (2.0 * std::numbers::pi);
    return {radius * std::cos(angle), radius * std::sin(angle), angle + std::numbers::pi / 2.0};
  }
  static NodeId node(std::size_t robot, std::uint64_t i) { return {{kRobots[robot], 1}, i}; }

  // Errors stay within their sigmas' double: what is true never looks false.
  static Se2 disturbed(const Se2& T, const Sigmas& sigmas, Random& random) {
    const double x = uniform(random, 1.7 * sigmas.m), y = uniform(random, 1.7 * sigmas.m);
    return T * Se2(x, y, uniform(random, 1.7 * sigmas.rad));
  }
  static NewFactor between(const NodeId& a, const NodeId& b, const Se2& T_a_b, const Sigmas& sigmas,
                           FactorKind kind) {
    const double position = 1.0 / (sigmas.m * sigmas.m), heading = 1.0 / (sigmas.rad * sigmas.rad);
    NewFactor factor;
    factor.type = FactorType{1};
    factor.kind = kind;
    factor.nodes = {a, b};
    factor.numbers = {T_a_b.x(), T_a_b.y(), T_a_b.theta(), position, 0.0,
                      0.0,       position,  0.0,           heading};
    return factor;
  }
  NewFactor true_loop(std::uint64_t i, std::size_t other, std::uint64_t j, Random& random) const {
    const Se2 T = truth(other, j).inverse() * truth(robot_, i);
    return between(node(other, j), node(robot_, i), disturbed(T, kLoop, random), kLoop,
                   FactorKind::kLoop);
  }
  // Of two places at least a quarter of a lap apart it says that they are near each other.
  NewFactor false_loop(std::uint64_t i, std::uint64_t last, Random& random) const {
    std::uint64_t j = draw(random, 0, last);
    while ((i + 1000 * kLap - j + kLap / 4) % kLap < kLap / 2) j = j == 0 ? last : j - 1;
    const Se2 T(uniform(random, 2.0), uniform(random, 2.0), uniform(random, 3.0));
    return between(node(robot_, j), node(robot_, i), T, kLoop, FactorKind::kLoop);
  }
  // The other robot's pose at the place of our pose i: the newest that came before `before`.
  std::optional<std::uint64_t> met(std::size_t other, std::uint64_t i, std::uint64_t before) const {
    const std::uint64_t laps = 1 + place(robot_, i) / kLap;
    std::uint64_t j = place(robot_, i) + laps * kLap - place(other, 0);
    while (j >= before && j >= kLap) j -= kLap;
    return j < before ? std::optional(j) : std::nullopt;
  }

  // Odometry alone, in a frame that begins at the first pose.
  const Se2& dead_reckoned(std::uint64_t i) {
    while (odometry_.size() <= i) {
      const std::uint64_t k = odometry_.size();
      std::seed_seq names{seed_, static_cast<std::uint64_t>(robot_), k, std::uint64_t{7}};
      Random random(names);
      motions_.push_back(
          k == 0 ? Se2()
                 : disturbed(truth(robot_, k - 1).inverse() * truth(robot_, k), kOdometry, random));
      odometry_.push_back(k == 0 ? Se2() : odometry_.back() * motions_.back());
    }
    return odometry_[i];
  }

  Step drive(std::uint64_t i, Random& random) {
    const Se2& T_odom_body = dead_reckoned(i);
    const std::vector<double> pose{T_odom_body.x(), T_odom_body.y(), T_odom_body.theta()};
    Step step;
    step.transaction.variables.push_back({node(robot_, i), VariableType::kPose2, pose, 0, pose});
    std::vector<NewFactor>& factors = step.transaction.factors;
    if (i > 0)
      factors.push_back(between(node(robot_, i - 1), node(robot_, i), motions_[i], kOdometry,
                                FactorKind::kOdometry));
    if (i >= kLap && i % 5 == 0) factors.push_back(true_loop(i, robot_, i - kLap, random));
    const std::size_t other = (robot_ + 1) % kRobots.size();
    if (i % 15 == 7) {
      if (const auto j = met(other, i, i > 10 ? i - 10 : 0))
        factors.push_back(true_loop(i, other, *j, random));
    }
    if (i > kLap && i % 20 == 13) {
      step.false_factor = factors.size();
      factors.push_back(false_loop(i, i - 1, random));
    }
    return step;
  }

  Step revisit(Random& random) const {
    Step step;
    const std::uint64_t i = draw(random, kLap, poses_ - 1), kind = draw(random, 0, 5);
    if (kind == 0) step.false_factor = 0;
    const std::size_t other = kind < 3 ? (robot_ + 1) % kRobots.size() : robot_;
    step.transaction.factors.push_back(kind == 0 ? false_loop(i, poses_ - 1, random)
                                       : other == robot_
                                           ? true_loop(i, robot_, i - kLap, random)
                                           : true_loop(i, other, *met(other, i, poses_), random));
    return step;
  }

  std::uint64_t seed_;
  std::size_t robot_;
  std::uint64_t poses_;
  std::vector<Se2> odometry_, motions_;
};

}  // namespace cairn::test
