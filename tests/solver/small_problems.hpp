// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>
#include <vector>

#include "cairn/factors/between.hpp"
#include "cairn/factors/landmark_xy.hpp"
#include "cairn/factors/landmark_xyz.hpp"
#include "cairn/graph/graph.hpp"

namespace cairn::test {

/// Repeatable normal numbers.
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint32_t seed) : engine_(seed) {}
  double number(double scale) { return scale * normal_(engine_); }
  template <int N>
  Eigen::Matrix<double, N, 1> vector(double scale) {
    return scale * Eigen::Matrix<double, N, 1>::NullaryExpr([&] { return normal_(engine_); });
  }
  /// Positive definite, not diagonal.
  template <int N>
  Eigen::Matrix<double, N, N> information() {
    const Eigen::Matrix<double, N, N> root =
        Eigen::Matrix<double, N, N>::NullaryExpr([&] { return normal_(engine_); });
    return root * root.transpose() + Eigen::Matrix<double, N, N>::Identity();
  }

 private:
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
};

/// The types of a world of either dimension, so that one test serves both.
struct Plane {
  using Pose = Se2;
  using Between = BetweenSe2;
  using Landmark = LandmarkXy;
  static constexpr int kPose = 3, kPoint = 2;
  static auto& poses(auto& values) { return values.pose2; }
  static auto& points(auto& values) { return values.point2; }
  static auto add_pose(Graph& graph, std::uint64_t id, const Pose& T) {
    return graph.add_pose2({id}, T);
  }
  static auto add_point(Graph& graph, std::uint64_t id, const Eigen::Vector2d& p) {
    return graph.add_point2({id}, p);
  }
  static Pose on_circle(double angle) {
    return {10.0 * std::cos(angle), 10.0 * std::sin(angle), angle + std::numbers::pi / 2.0};
  }
};

struct Space {
  using Pose = Se3;
  using Between = BetweenSe3;
  using Landmark = LandmarkXyz;
  static constexpr int kPose = 6, kPoint = 3;
  static auto& poses(auto& values) { return values.pose3; }
  static auto& points(auto& values) { return values.point3; }
  static auto add_pose(Graph& graph, std::uint64_t id, const Pose& T) {
    return graph.add_pose3({id}, T);
  }
  static auto add_point(Graph& graph, std::uint64_t id, const Eigen::Vector3d& p) {
    return graph.add_point3({id}, p);
  }
  static Pose on_circle(double angle) {  // climbing and rolling, so that no axis is special
    return {So3::exp({0.3 * std::sin(angle), 0.2 * std::cos(angle), angle}),
            Eigen::Vector3d(10.0 * std::cos(angle), 10.0 * std::sin(angle), std::sin(2.0 * angle))};
  }
};

/// A drive around a circle: `count` poses, an edge from each to the next (the last is the loop
/// closure), `chords` more edges across, and `landmarks` points from id max(1000, count) on, seen
/// from three poses each. Measurements are off by `noise`, the start (not of pose 0) by
/// `start_noise`.
template <class World>
Graph circle(std::uint64_t count, std::uint64_t chords, std::uint64_t landmarks, double noise,
             double start_noise, std::uint32_t seed) {
  RandomNumbers random(seed);
  Graph graph;
  std::vector<typename World::Pose> truth;
  for (std::uint64_t i = 0; i < count; ++i) {
    truth.push_back(World::on_circle(2.0 * std::numbers::pi * static_cast<double>(i) /
                                     static_cast<double>(count)));
    const auto off = random.template vector<World::kPose>(i == 0 ? 0.0 : start_noise);
    EXPECT_TRUE(World::add_pose(graph, i, truth[i].retract(off)));
  }
  const auto connect = [&](std::uint64_t a, std::uint64_t b, FactorKind kind) {
    const auto T_a_b = truth[a].inverse() * truth[b];
    const typename World::Between edge{T_a_b.retract(random.template vector<World::kPose>(noise)),
                                       random.template information<World::kPose>()};
    EXPECT_TRUE(graph.add_factor(edge, {VariableId{a}, VariableId{b}}, kind));
  };
  for (std::uint64_t i = 0; i < count; ++i)
    connect(i, (i + 1) % count, i + 1 < count ? FactorKind::kOdometry : FactorKind::kLoop);
  for (std::uint64_t i = 0; i < chords; ++i)
    connect(i % count, (i + count / 3) % count, FactorKind::kLoop);
  const std::uint64_t first_landmark = std::max<std::uint64_t>(1000, count);
  for (std::uint64_t l = 0; l < landmarks; ++l) {
    const auto point = random.template vector<World::kPoint>(6.0).eval();
    const auto off = random.template vector<World::kPoint>(start_noise).eval();
    EXPECT_TRUE(World::add_point(graph, first_landmark + l, point + off));
    for (const std::uint64_t pose : {l % count, (l + 1) % count, (l + count / 2) % count}) {
      typename World::Landmark seen{};
      seen.p_sensor_measured =
          truth[pose].inverse() * point + random.template vector<World::kPoint>(noise);
      seen.information = random.template information<World::kPoint>();
      EXPECT_TRUE(graph.add_factor(seen, {VariableId{pose}, VariableId{first_landmark + l}}));
    }
  }
  return graph;
}

/// The bits of all estimates.
inline std::vector<double> bits(const Values& values) {
  std::vector<double> all;
  const auto append = [&](const auto& v) { all.insert(all.end(), v.data(), v.data() + v.size()); };
  for (const Se2& T : values.pose2) append(T.to_vector());
  for (const Se3& T : values.pose3) {
    append(T.rotation().quaternion().coeffs());
    append(T.translation());
  }
  for (const auto& p : values.point2) append(p);
  for (const auto& p : values.point3) append(p);
  return all;
}

}  // namespace cairn::test
