// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/loop_cycles.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstdlib>
#include <tuple>
#include <type_traits>
#include <utility>

namespace cairn {
namespace {

// A direction that a measurement says nothing about is known to so little of the others.
constexpr double kLeastInformation = 1e-12;

template <class Pose>
auto& poses_of(Values& values) {
  if constexpr (std::is_same_v<Pose, Se2>)
    return values.pose2;
  else
    return values.pose3;
}

template <class Pose>
std::vector<RelativePose<Pose>> relative_poses(const FactorBatch& batch) {
  if constexpr (std::is_same_v<Pose, Se2>)
    return batch.relative_poses2();
  else
    return batch.relative_poses3();
}

// At the measurement itself, where the error is zero. Changes `values` of both poses.
template <class Pose>
UncertainPose<Pose> measurement(const FactorBatch& batch, std::uint32_t factor,
                                const RelativePose<Pose>& measured, Values& values) {
  constexpr int d = UncertainPose<Pose>::kDimension;
  poses_of<Pose>(values)[measured.a] = Pose();
  poses_of<Pose>(values)[measured.b] = measured.T_a_b;
  Eigen::Matrix<double, d, 1> residual;
  Eigen::Matrix<double, d, d> J_a, J_b;
  double* const jacobians[] = {J_a.data(), J_b.data()};
  batch.evaluate_into(factor, {.values = values}, residual.data(), jacobians);
  Eigen::Matrix<double, d, d> information = J_b.transpose() * J_b;
  information.diagonal().array() += kLeastInformation * information.trace();
  return {measured.T_a_b, information.llt().solve(Eigen::Matrix<double, d, d>::Identity()).eval()};
}

}  // namespace

template <class Pose>
double disagreement(const UncertainPose<Pose>& a, const UncertainPose<Pose>& b) {
  const typename Pose::Tangent e = (a.T.inverse() * b.T).log();
  const typename UncertainPose<Pose>::Covariance S = a.covariance + b.covariance;
  return e.dot(S.ldlt().solve(e));
}

template <class Pose>
LoopCycles<Pose>::LoopCycles(const Graph& graph) {
  Values values = graph.values();
  next_.resize(poses_of<Pose>(values).size());
  has_previous_.resize(next_.size());
  places_.resize(next_.size());
  std::vector<std::vector<RelativePose<Pose>>> measured;
  for (const auto& batch : graph.batches()) measured.push_back(relative_poses<Pose>(*batch));
  for (std::size_t place = 0; place < graph.factor_count(); ++place) {
    const auto [b, index] = graph.factors()[place];
    const FactorBatch& batch = *graph.batches()[b];
    if (measured[b].empty() || batch.kinds()[index] == FactorKind::kOther) continue;
    const RelativePose<Pose>& edge = measured[b][index];
    const UncertainPose<Pose> T_a_b = measurement(batch, index, edge, values);
    if (batch.kinds()[index] == FactorKind::kOdometry)
      add_odometry(edge.a, edge.b, T_a_b);
    else
      loops_.push_back({place, edge.a, edge.b, T_a_b, false});
  }
  chain_up();
  const auto place_of = [this](std::uint32_t pose) {
    return std::pair(places_[pose].chain, places_[pose].number);
  };
  for (Loop& loop : loops_) {
    if (place_of(loop.a) <= place_of(loop.b)) continue;
    std::swap(loop.a, loop.b);
    loop.T_a_b = loop.T_a_b.inverse();
    loop.turned = true;
  }
  std::sort(loops_.begin(), loops_.end(), [&](const Loop& x, const Loop& y) {
    const Place &xa = places_[x.a], &xb = places_[x.b], &ya = places_[y.a], &yb = places_[y.b];
    return std::tie(xa.chain, xb.chain, xa.number, xb.number, x.factor) <
           std::tie(ya.chain, yb.chain, ya.number, yb.number, y.factor);
  });
}

// An edge that would make a fork stays out: nothing is lost but a way to compare.
template <class Pose>
void LoopCycles<Pose>::add_odometry(std::uint32_t a, std::uint32_t b,
                                    const UncertainPose<Pose>& T_a_b) {
  const bool forward = next_[a].other < 0 && !has_previous_[b];
  const bool backward = next_[b].other < 0 && !has_previous_[a];
  if (!forward && !backward) return;
  next_[forward ? a : b] = {static_cast<int>(forward ? b : a), forward ? T_a_b : T_a_b.inverse()};
  has_previous_[forward ? b : a] = true;
}

template <class Pose>
void LoopCycles<Pose>::chain_up() {
  int chains = 0;
  for (std::size_t first = 0; first < places_.size(); ++first) {
    if (has_previous_[first]) continue;
    Place place{.chain = chains++};
    for (std::size_t pose = first;;) {
      places_[pose] = place;
      const Link& link = next_[pose];
      if (link.other < 0) break;
      ++place.number;
      place.T_start_pose = place.T_start_pose * link.T.T;
      const auto to_start = place.T_start_pose.adjoint();
      place.covariance += to_start * link.T.covariance * to_start.transpose();
      pose = static_cast<std::size_t>(link.other);
    }
  }
}

template <class Pose>
bool LoopCycles<Pose>::share_chains(const Loop& x, const Loop& y) const {
  return places_[x.a].chain >= 0 && places_[x.a].chain == places_[y.a].chain &&
         places_[x.b].chain == places_[y.b].chain;
}

template <class Pose>
int LoopCycles<Pose>::distance(const Loop& x, const Loop& y) const {
  return std::max(std::abs(places_[x.a].number - places_[y.a].number),
                  std::abs(places_[x.b].number - places_[y.b].number));
}

template <class Pose>
bool LoopCycles<Pose>::nearby(const Loop& x, const Loop& y) const {
  return share_chains(x, y) && std::abs(places_[x.a].number - places_[y.a].number) <= kReach;
}

template <class Pose>
double LoopCycles<Pose>::chi2(const Loop& x, const Loop& y) const {
  return disagreement(between(y.a, x.a) * x.T_a_b * between(x.b, y.b), y.T_a_b);
}

template <class Pose>
UncertainPose<Pose> LoopCycles<Pose>::between(std::uint32_t from, std::uint32_t to) const {
  const Place &a = places_[from], &b = places_[to];
  if (b.number < a.number) return between(to, from).inverse();
  const auto from_start = b.T_start_pose.inverse().adjoint();
  return {a.T_start_pose.inverse() * b.T_start_pose,
          from_start * (b.covariance - a.covariance) * from_start.transpose()};
}

template double disagreement(const UncertainPose<Se2>&, const UncertainPose<Se2>&);
template double disagreement(const UncertainPose<Se3>&, const UncertainPose<Se3>&);
template class LoopCycles<Se2>;
template class LoopCycles<Se3>;

}  // namespace cairn
