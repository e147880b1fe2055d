// SPDX-License-Identifier: BSD-3-Clause
#include "benchmarks/support/gate_scores.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "cairn/evaluation/alignment.hpp"
#include "cairn/evaluation/statistics.hpp"
#include "cairn/evaluation/trajectory_error.hpp"
#include "cairn/factors/between.hpp"
#include "cairn/io/trajectory.hpp"
#include "cairn/solver/marginals.hpp"

namespace cairn::bench {
namespace {

constexpr double kChi2Of99Percent = 16.812;  // six degrees of freedom

struct Poses {
  std::vector<Se3> all;
  bool planar;
};

Poses poses_of(const Graph& graph) {
  Poses poses;
  const Trajectory trajectory = trajectory_of(graph, {});
  poses.planar = trajectory.planar;
  for (const TrajectoryPose& pose : trajectory.poses) poses.all.push_back(pose.T_world_body);
  return poses;
}

std::vector<Se3> aligned(const Alignment& alignment, std::vector<Se3> poses) {
  for (Se3& pose : poses) pose = alignment * pose;
  return poses;
}

const Se3& nearest(const std::vector<Se3>& path, const Se3& pose) {
  return *std::min_element(path.begin(), path.end(), [&pose](const Se3& x, const Se3& y) {
    return (x.translation() - pose.translation()).squaredNorm() <
           (y.translation() - pose.translation()).squaredNorm();
  });
}

std::vector<Se3> every(std::size_t step, const std::vector<Se3>& poses) {
  std::vector<Se3> some;
  for (std::size_t i = 0; i < poses.size(); i += step) some.push_back(poses[i]);
  return some;
}

// A relative pose with the covariance of d in T * Exp(d).
struct Stretch {
  Se3 T;
  Matrix6d covariance = Matrix6d::Zero();

  void append(const Se3& next, const Matrix6d& covariance_of_next) {
    const Matrix6d J = next.inverse().adjoint();
    T = T * next;
    covariance = J * covariance * J.transpose() + covariance_of_next;
  }
};

Matrix6d covariance_of(const BetweenSe3& factor) {
  return factor.information_in(ErrorChart::kLog).ldlt().solve(Matrix6d::Identity());
}
// Of the inverse of T with this covariance.
Matrix6d covariance_of_inverse(const Se3& T, const Matrix6d& covariance) {
  return T.adjoint() * covariance * T.adjoint().transpose();
}

class Referee {
 public:
  Referee(const Graph& graph, const std::set<std::size_t>& left_out) {
    const TypedBatch<BetweenSe3>& batch = *graph.find_batch<BetweenSe3>();
    for (std::size_t place = 0; place < graph.factor_count(); ++place) {
      const FactorRef factor = graph.factors()[place];
      const auto slots = graph.slots_of(factor);
      const std::uint64_t a = graph.variables()[slots[0]].id.value;
      const std::uint64_t b = graph.variables()[slots[1]].id.value;
      const BetweenSe3& edge = batch.factor(factor.index);
      if (batch.kinds()[factor.index] == FactorKind::kOdometry)
        odometry_.emplace(a, edge);
      else if (a >> 56 < b >> 56 && !left_out.contains(place))
        loops_.push_back({a, b, edge.T_a_b_measured, covariance_of(edge)});
      else if (a >> 56 > b >> 56 && !left_out.contains(place))
        loops_.push_back({b, a, edge.T_a_b_measured.inverse(),
                          covariance_of_inverse(edge.T_a_b_measured, covariance_of(edge))});
    }
  }

  [[nodiscard]] PairScore score(double noise_scale) const {
    PairScore score;
    for (std::size_t x = 0; x < loops_.size(); ++x) {
      for (std::size_t y = x + 1; y < loops_.size(); ++y) {
        if (loops_[x].a >> 56 != loops_[y].a >> 56 || loops_[x].b >> 56 != loops_[y].b >> 56)
          continue;
        const double chi2 = chi2_of(loops_[x], loops_[y]);
        ++score.pairs;
        score.consistent_as_stated += chi2 <= kChi2Of99Percent;
        score.consistent += chi2 <= kChi2Of99Percent * noise_scale;
      }
    }
    return score;
  }

 private:
  struct Loop {
    std::uint64_t a, b;
    Se3 T_a_b;
    Matrix6d covariance;
  };

  // Around the cycle that begins at x.a.
  [[nodiscard]] double chi2_of(const Loop& x, const Loop& y) const {
    Stretch cycle;
    cycle.append(x.T_a_b, x.covariance);
    walk(cycle, x.b, y.b);
    cycle.append(y.T_a_b.inverse(), covariance_of_inverse(y.T_a_b, y.covariance));
    walk(cycle, y.a, x.a);
    const Vector6d e = cycle.T.log();
    return e.dot(cycle.covariance.ldlt().solve(e));
  }
  void walk(Stretch& stretch, std::uint64_t from, std::uint64_t to) const {
    for (; from < to; ++from) {
      const BetweenSe3& step = odometry_.at(from);
      stretch.append(step.T_a_b_measured, covariance_of(step));
    }
    for (; from > to; --from) {
      const BetweenSe3& step = odometry_.at(from - 1);
      stretch.append(step.T_a_b_measured.inverse(),
                     covariance_of_inverse(step.T_a_b_measured, covariance_of(step)));
    }
  }

  std::map<std::uint64_t, BetweenSe3> odometry_;  // by the id it leads from
  std::vector<Loop> loops_;
};

}  // namespace

double trajectory_error_m(const Graph& reference, const Graph& estimate) {
  const Poses truth = poses_of(reference), poses = poses_of(estimate);
  const Alignment fit = align(AlignmentKind::kSe3, truth.all, poses.all, truth.planar);
  return compute_statistics(absolute_errors(truth.all, aligned(fit, poses.all)).translation_m).rmse;
}

double extent_m(const Graph& graph) {
  const Poses poses = poses_of(graph);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Se3& pose : poses.all) middle += pose.translation();
  middle /= static_cast<double>(poses.all.size());
  std::vector<double> distances;
  for (const Se3& pose : poses.all) distances.push_back((pose.translation() - middle).norm());
  return compute_statistics(distances).rmse;
}

double distance_to_path_m(const Graph& estimate, const Graph& truth) {
  constexpr int kRounds = 30;
  const std::vector<Se3> path = every(5, poses_of(truth).all);
  std::vector<Se3> poses = every(10, poses_of(estimate).all);
  double mean = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Se3> partners;
    std::vector<double> distances;
    for (const Se3& pose : poses) {
      partners.push_back(nearest(path, pose));
      distances.push_back((partners.back().translation() - pose.translation()).norm());
    }
    mean = std::min(mean, compute_statistics(distances).mean);
    const Alignment fit = align(AlignmentKind::kSe3, partners, poses, true);
    poses = aligned(fit, std::move(poses));
  }
  return mean;
}

std::set<std::size_t> indistinguishable(const Graph& graph, const Graph& solved_without,
                                        const std::set<std::size_t>& loops, double noise_scale) {
  std::set<std::size_t> alike;
  const Result<Marginals> marginals = Marginals::compute(solved_without);
  if (!marginals) return alike;
  for (const std::size_t place : loops) {
    const FactorRef factor = graph.factors()[place];
    const auto slots = graph.slots_of(factor);
    Vector6d e;
    Matrix6d J;
    double* const jacobians[] = {nullptr, J.data()};
    graph.batches()[factor.batch]->evaluate_into(factor.index, {.values = solved_without.values()},
                                                 e.data(), jacobians);
    const Matrix6d S = Matrix6d::Identity() +
                       J * marginals->relative_covariance(slots[0], slots[1]) * J.transpose();
    if (e.dot(S.ldlt().solve(e)) <= kChi2Of99Percent * noise_scale) alike.insert(place);
  }
  return alike;
}

PairScore score_pairs(const Graph& graph, const std::set<std::size_t>& left_out,
                      double noise_scale) {
  return Referee(graph, left_out).score(noise_scale);
}

}  // namespace cairn::bench
