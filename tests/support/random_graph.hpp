// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include "cairn/factors/between.hpp"
#include "cairn/graph/graph.hpp"
#include "tests/support/random.hpp"

namespace cairn::test {

struct RandomGraphOptions {
  std::uint64_t seed = 1;
  std::size_t poses = 30;
  std::size_t loops = 20;     ///< between poses at least two apart
  double noise = 0.01;        ///< standard deviation of every tangent coefficient of a measurement
  double start_noise = 0.05;  ///< of the start values
  bool full_information =
      true;  ///< random full matrices around noise^-2; otherwise exactly noise^-2 I
};

/// A pose graph with known truth: a random walk, odometry along it, and loop closures. Ids are 0,
/// 1, 2, ...
template <class Pose>
struct RandomGraph {
  Graph graph;
  std::vector<Pose> truth;
};

namespace internal {

template <class Pose>
struct PoseGraphTypes;
template <>
struct PoseGraphTypes<Se2> {
  using Between = BetweenSe2;
  static Se2 random_step(Random& random) {
    return {1.0 + 0.2 * random.normal(), 0.1 * random.normal(), 0.5 * random.normal()};
  }
  static auto add(Graph& graph, VariableId id, const Se2& T) { return graph.add_pose2(id, T); }
};
template <>
struct PoseGraphTypes<Se3> {
  using Between = BetweenSe3;
  static Se3 random_step(Random& random) {
    Se3::Tangent v = 0.3 * random.vector<6>();
    v[0] += 1.0;
    return Se3::exp(v);
  }
  static auto add(Graph& graph, VariableId id, const Se3& T) { return graph.add_pose3(id, T); }
};

}  // namespace internal

template <class Pose>
RandomGraph<Pose> random_pose_graph(const RandomGraphOptions& options = {}) {
  using Types = internal::PoseGraphTypes<Pose>;
  constexpr int kDim = Types::Between::kDimension;
  using Matrix = Eigen::Matrix<double, kDim, kDim>;
  Random random(options.seed);
  RandomGraph<Pose> result;
  for (std::size_t i = 0; i < options.poses; ++i) {
    result.truth.push_back(i == 0 ? Pose() : result.truth.back() * Types::random_step(random));
    const Pose start =
        result.truth.back().retract(random.vector<kDim>(i == 0 ? 0.0 : options.start_noise));
    CAIRN_CHECK(Types::add(result.graph, VariableId{i}, start).ok(), "ids are unique");
  }
  const double weight = options.noise > 0.0 ? 1.0 / (options.noise * options.noise) : 1.0;
  const auto connect = [&](std::size_t a, std::size_t b, FactorKind kind) {
    const Pose T_a_b =
        (result.truth[a].inverse() * result.truth[b]).retract(random.vector<kDim>(options.noise));
    const Matrix Omega =
        options.full_information ? random.information<kDim>() : Matrix(Matrix::Identity());
    const auto added = result.graph.add_factor(typename Types::Between{T_a_b, weight * Omega},
                                               {VariableId{a}, VariableId{b}}, kind);
    CAIRN_CHECK(added.ok(), "random factors are valid");
  };
  for (std::size_t i = 1; i < options.poses; ++i) connect(i - 1, i, FactorKind::kOdometry);
  for (std::size_t i = 0; options.poses > 2 && i < options.loops; ++i) {
    const std::size_t span = 2 + random.index(options.poses - 2);
    const std::size_t a = random.index(options.poses - span);
    connect(a, a + span, FactorKind::kLoop);
  }
  return result;
}

}  // namespace cairn::test
