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

std::vector<PoseSigmas> DriftBound::seen_from(std::size_t keyframe) const {
  constexpr double kUnseen = std::numeric_limits<double>::infinity();
  struct Reached {
    double variance;
    std::size_t keyframe;
    bool operator>(const Reached& other) const {
      return std::pair(variance, keyframe) > std::pair(other.variance, other.keyframe);
    }
  };
  std::vector<Eigen::Matrix3d> covariances(ties_.size(), Eigen::Matrix3d::Zero());
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
      const Eigen::Matrix3d there = J * covariances[at.keyframe] * J.transpose() + tie.covariance;
      // Never less than on the way there, so that no path is gone again and again.
      const double variance = std::max(at.variance, worst_variance(there));
      if (variance >= least[tie.to]) continue;
      least[tie.to] = variance;
      covariances[tie.to] = there;
      open.push({variance, tie.to});
    }
  }
  std::vector<PoseSigmas> sigmas(ties_.size());
  for (std::size_t k = 0; k < ties_.size(); ++k)
    sigmas[k] = {std::sqrt(worst_variance(covariances[k])), std::sqrt(covariances[k](2, 2))};
  return sigmas;
}

}  // namespace cairn
