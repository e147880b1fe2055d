// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/loop_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace cairn {
namespace {

constexpr double kLeastShare = 0.01;  // of a loop's information that is not its own solution's

}  // namespace

template <class Pose>
double LoopFit<Pose>::chi2(std::size_t factor) const {
  const auto [batch, index] = graph_.factors()[factor];
  double chi2 = 0.0;
  graph_.batches()[batch]->evaluate_chi2(index, index + 1,
                                         {.values = graph_.values(), .chart = chart_}, &chi2);
  return chi2;
}

template <class Pose>
double LoopFit<Pose>::chi2_without(std::size_t factor, const Marginals& with) const {
  const Whitened loop = whitened(factor);
  const Matrix S = loop.J * with.relative_covariance(loop.a, loop.b) * loop.J.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix> own(S);
  const Vector error = own.eigenvectors().transpose() * loop.error;
  const Vector left = (1.0 - own.eigenvalues().array()).max(kLeastShare);
  return error.cwiseAbs2().cwiseQuotient(left).sum();
}

template <class Pose>
double LoopFit<Pose>::chi2_of_newcomer(std::size_t factor, const Marginals& without) const {
  const Whitened loop = whitened(factor);
  const Matrix both = Matrix::Identity() +
                      loop.J * without.relative_covariance(loop.a, loop.b) * loop.J.transpose();
  return loop.error.dot(both.ldlt().solve(loop.error));
}

template <class Pose>
typename LoopFit<Pose>::Whitened LoopFit<Pose>::whitened(std::size_t factor) const {
  const FactorRef ref = graph_.factors()[factor];
  const std::vector<VariableSlot> ends = graph_.slots_of(ref);
  Whitened result{.a = ends[0], .b = ends[1], .error = {}, .J = {}};
  double* const jacobians[] = {nullptr, result.J.data()};
  graph_.batches()[ref.batch]->evaluate_into(
      ref.index, {.values = graph_.values(), .chart = chart_}, result.error.data(), jacobians);
  return result;
}

template class LoopFit<Se2>;
template class LoopFit<Se3>;

}  // namespace cairn
