// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/laser/drift_bound.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

namespace cairn {
namespace {

double worst_variance(const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix2d P = covariance.topLeftCorner<2, 2>();
  const double middle = 0.5 * P.trace(), half = 0.5 * (P(0, 0) - P(1, 1));
  return middle + std::hypot(half, P(0, 1));
}

}  // namespace

void DriftBound::add_keyframe(const Se2& T_before_this, const Eigen::Matrix3d& covariance) {
  ties_.emplace_back();
  if (ties_.size() > 1) tie(ties_.size() - 2, ties_.size() - 1, T_before_this, covariance);
}

void DriftBound::add_loop(std::size_t from, std::size_t to, const Se2& T_from_to,
                          const Eigen::Matrix3d& covariance) {
  tie(from, to, T_from_to, covariance);
}

void DriftBound::tie(std::size_t from, std::size_t to, const Se2& T,
                     const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix3d J = T.adjoint();
  ties_[from].push_back({to, T, covariance});
  ties_[to].push_back({from, T.inverse(), J * covariance * J.transpose()});
}

std::vector<DriftBound::Seen> DriftBound::paths_from(std::size_t keyframe) const {
  constexpr double kUnseen = std::numeric_limits<double>::infinity();
  struct Reached {
    double variance;
    std::size_t keyframe;
    bool operator>(const Reached& other) const {
      return std::pair(variance, keyframe) > std::pair(other.variance, other.keyframe);
    }
  };
  std::vector<Seen> seen(ties_.size(), {Se2(), Eigen::Matrix3d::Zero()});
  std::vector<double> least(ties_.size(), kUnseen);
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> open;
  least[keyframe] = 0.0;
  open.push({0.0, keyframe});
  while (!open.empty()) {
    const Reached at = open.top();
    open.pop();
    if (at.variance > least[at.keyframe]) continue;
    for (const Tie& tie : ties_[at.keyframe]) {
      const Eigen::Matrix3d J = tie.T_from_to.inverse().adjoint();
      const Eigen::Matrix3d there =
          J * seen[at.keyframe].covariance * J.transpose() + tie.covariance;
      // Never less than on the way there, so that no path is gone again and again.
      const double variance = std::max(at.variance, worst_variance(there));
      if (variance >= least[tie.to]) continue;
      least[tie.to] = variance;
      seen[tie.to] = {seen[at.keyframe].T_from_it * tie.T_from_to, there};
      open.push({variance, tie.to});
    }
  }
  return seen;
}

std::vector<PoseSigmas> DriftBound::seen_from(std::size_t keyframe) const {
  std::vector<PoseSigmas> sigmas;
  sigmas.reserve(ties_.size());
  for (const Seen& seen : paths_from(keyframe))
    sigmas.push_back(
        {std::sqrt(worst_variance(seen.covariance)), std::sqrt(seen.covariance(2, 2))});
  return sigmas;
}

}  // namespace cairn
