// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "cairn/graph/graph.hpp"

namespace cairn {

/// A relative pose and the covariance of d in T * Exp(d) (m, rad).
template <class Pose>
struct UncertainPose {
  static constexpr int kDimension = Pose::Tangent::RowsAtCompileTime;
  using Covariance = Eigen::Matrix<double, kDimension, kDimension>;

  Pose T{};
  Covariance covariance = Covariance::Zero();

  /// As if both errors were independent.
  friend UncertainPose operator*(const UncertainPose& a_b, const UncertainPose& b_c) {
    const Covariance moved = b_c.T.inverse().adjoint();
    return {a_b.T * b_c.T, moved * a_b.covariance * moved.transpose() + b_c.covariance};
  }
  [[nodiscard]] UncertainPose inverse() const {
    const Covariance moved = T.adjoint();
    return {T.inverse(), moved * covariance * moved.transpose()};
  }
};

/// Between the ends of loops that can support each other, in keyframes.
constexpr int kReach = 10;

/// e^T S^-1 e of the difference of two measurements of one relative pose.
template <class Pose>
double disagreement(const UncertainPose<Pose>& a, const UncertainPose<Pose>& b);

/// The loop closures of a graph between poses of one type, and the cycles that two of them make
/// with the odometry between their ends. Covariances are what the factors state.
template <class Pose>
class LoopCycles {
 public:
  explicit LoopCycles(const Graph& graph);

  struct Loop {
    std::size_t factor;  ///< place in Graph::factors()
    std::uint32_t a, b;  ///< indices of the poses; a comes first, by chain of odometry and place
    UncertainPose<Pose> T_a_b;
    bool turned;  ///< the factor has b first
  };
  /// Ascending by chains and places of their ends.
  [[nodiscard]] const std::vector<Loop>& loops() const { return loops_; }
  /// Both lead from one chain of odometry to the same other one (or along the same one).
  [[nodiscard]] bool share_chains(const Loop& x, const Loop& y) const;
  /// Its ends are on two chains of odometry.
  [[nodiscard]] bool leads_elsewhere(const Loop& loop) const {
    return places_[loop.a].chain != places_[loop.b].chain;
  }
  /// The larger distance between their ends, in keyframes. They share chains.
  [[nodiscard]] int distance(const Loop& x, const Loop& y) const;
  /// They share chains, and their first ends are in reach of each other. Of those that come after a
  /// loop in loops() these are the next ones.
  [[nodiscard]] bool nearby(const Loop& x, const Loop& y) const;
  /// Of the cycle x, odometry, y, odometry: chi-square distributed with the pose's dimension where
  /// both are true and the stated covariances are right. They share chains.
  [[nodiscard]] double chi2(const Loop& x, const Loop& y) const;

 private:
  struct Place {
    int chain = -1, number = 0;
    Pose T_start_pose{};  ///< by odometry
    /// Of that, as d in Exp(d) * T: sums along the chain.
    typename UncertainPose<Pose>::Covariance covariance = UncertainPose<Pose>::Covariance::Zero();
  };
  struct Link {
    int other = -1;
    UncertainPose<Pose> T;  ///< to the other one
  };

  void add_odometry(std::uint32_t a, std::uint32_t b, const UncertainPose<Pose>& T_a_b);
  void chain_up();
  [[nodiscard]] UncertainPose<Pose> between(std::uint32_t from, std::uint32_t to) const;

  std::vector<Link> next_;
  std::vector<bool> has_previous_;
  std::vector<Place> places_;  ///< by pose index
  std::vector<Loop> loops_;
};

}  // namespace cairn
