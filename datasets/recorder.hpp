// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "datasets/noise.hpp"
#include "datasets/simulate.hpp"
#include "datasets/walk.hpp"

namespace cairn {

/// The independent random streams of one simulation.
enum RandomStream : std::uint64_t { kWorldStream, kNoiseStream, kMistakeStream };

/// How well a robot measures its own motion and its loop closures.
struct WalkSigmas {
  PoseSigmas odometry, closure;

  /// Times the noise factor; 0 (exact measurements) leaves them.
  [[nodiscard]] WalkSigmas scaled(double noise) const {
    return noise > 0.0 ? WalkSigmas{odometry.scaled(noise), closure.scaled(noise)} : *this;
  }
};

/// Exactly `count` of `total`, each choice equally likely.
std::vector<bool> choose(std::size_t count, std::size_t total, Random& random);
/// Turns what the robot did into what it measured: poses by dead reckoning, odometry, loop
/// closures, some of them false.
template <class Pose>
class Recorder {
 public:
  Recorder(Walk<Pose> walk, const WalkSigmas& sigmas, const SimulationOptions& options)
      : walk_(std::move(walk)),
        sigmas_(sigmas),
        exact_(options.noise == 0.0),
        noise_(options.seed, kNoiseStream),
        mistakes_(options.seed, kMistakeStream) {
    const double loops = static_cast<double>(walk_.loops.size());
    const auto mistakes = static_cast<std::size_t>(std::llround(options.outliers * loops));
    is_false_ = choose(mistakes, walk_.loops.size(), mistakes_);
  }

  /// Called when the robot stands at pose i, to add what other sensors see; must keep `truth` in
  /// step when it adds variables.
  using Observe = std::function<void(std::uint32_t i, SimulatedGraph& out)>;

  SimulatedGraph record(const Observe& observe = {}) {
    out_.graph.reserve(walk_.poses.size());
    std::size_t loop = 0;
    for (std::uint32_t i = 0; i < walk_.poses.size(); ++i) {
      add_next_pose(i);
      for (; loop < walk_.loops.size() && walk_.loops[loop].to == i; ++loop) add_loop(loop);
      if (observe) observe(i, out_);
    }
    if constexpr (std::is_same_v<Pose, Se2>) {
      out_.truth.pose2 = std::move(walk_.poses);
    } else {
      out_.truth.pose3 = std::move(walk_.poses);
    }
    return std::move(out_);
  }

 private:
  [[nodiscard]] Pose relative(std::uint32_t a, std::uint32_t b) const {
    return walk_.poses[a].inverse() * walk_.poses[b];
  }

  void add_next_pose(std::uint32_t i) {
    if (i == 0) {
      reckoned_ = walk_.poses[0];
      add_pose(i);
      return;
    }
    const Pose T_a_b = relative(i - 1, i);
    const auto information = pose_information(sigmas_.odometry, T_a_b, 0.0);
    const auto odometry = draw_between(T_a_b, information, exact_, noise_);
    reckoned_ = (reckoned_ * odometry.T_a_b_measured).retract(Pose::Tangent::Zero());
    add_pose(i);
    add_between(odometry, i - 1, i, FactorKind::kOdometry);
  }

  void add_loop(std::size_t index) {
    const LoopPair& loop = walk_.loops[index];
    const Pose T_a_b = relative(loop.from, loop.to);
    const double axis_rad = noise_.uniform(0.0, std::numbers::pi);
    const auto closure =
        draw_between(T_a_b, pose_information(sigmas_.closure, T_a_b, axis_rad), exact_, noise_);
    const std::uint32_t from = is_false_[index] ? mistaken_pose(loop) : loop.from;
    const FactorRef added = add_between(closure, from, loop.to, FactorKind::kLoop);
    if (is_false_[index]) out_.outliers.push_back(added);
  }

  // The earlier pose that a false closure takes for loop.from: at another place where there is one.
  std::uint32_t mistaken_pose(const LoopPair& loop) {
    constexpr double kElsewhereM = 5.0;
    const auto distance_m = [&](std::uint32_t other) {
      return (walk_.poses[other].translation() - walk_.poses[loop.from].translation()).norm();
    };
    for (int attempt = 0;; ++attempt) {
      const auto other = static_cast<std::uint32_t>(mistakes_.index(loop.to - 1));
      const bool elsewhere = distance_m(other) >= kElsewhereM;
      if (other != loop.from && (elsewhere || attempt >= 100)) return other;
    }
  }

  void add_pose(std::uint32_t i) {
    if constexpr (std::is_same_v<Pose, Se2>) {
      CAIRN_CHECK(out_.graph.add_pose2({i}, reckoned_), "a simulated pose was refused");
    } else {
      CAIRN_CHECK(out_.graph.add_pose3({i}, reckoned_), "a simulated pose was refused");
    }
  }

  template <class Between>
  FactorRef add_between(const Between& factor, std::uint32_t from, std::uint32_t to,
                        FactorKind kind) {
    const auto added = out_.graph.add_factor(factor, {VariableId{from}, VariableId{to}}, kind);
    CAIRN_CHECK(added, "a simulated factor was refused");
    return *added;
  }

  Walk<Pose> walk_;
  WalkSigmas sigmas_;
  bool exact_;
  Random noise_, mistakes_;
  std::vector<bool> is_false_;
  Pose reckoned_;
  SimulatedGraph out_;
};

/// kLandmarks: three laps of a course, with odometry and the sensor of the options.
SimulatedGraph simulate_landmarks(const WalkSigmas& sigmas, const SimulationOptions& options,
                                  Random& random);

}  // namespace cairn
