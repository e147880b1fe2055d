// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/innovation.hpp"

#include <Eigen/Eigenvalues>

namespace cairn {
namespace {

constexpr double kLeastShare = 1e-4;  // below, nothing else says anything about a direction

struct Whitened {
  Eigen::VectorXd error;
  Eigen::MatrixXd solved;  // the solution's covariance of it
};

std::optional<Whitened> whiten(const Graph& graph, FactorRef factor, const Marginals& marginals) {
  const FactorEvaluation at =
      graph.batches()[factor.batch]->evaluate(factor.index, {.values = graph.values()});
  const std::vector<VariableSlot> slots = graph.slots_of(factor);
  if (slots.size() > 2) return std::nullopt;
  const Eigen::MatrixXd covariance = slots.size() == 1
                                         ? marginals.covariance(slots[0])
                                         : marginals.joint_covariance(slots[0], slots[1]);
  Eigen::MatrixXd J(at.residual.size(), covariance.rows());
  Eigen::Index column = 0;
  for (const Eigen::MatrixXd& block : at.jacobians) {
    J.middleCols(column, block.cols()) = block;
    column += block.cols();
  }
  Whitened result{at.residual, J * covariance * J.transpose()};
  if (!result.solved.allFinite() || !result.error.allFinite()) return std::nullopt;
  return result;
}

}  // namespace

std::optional<Innovation> innovation_inside(const Graph& graph, FactorRef factor,
                                            const Marginals& marginals) {
  const auto whitened = whiten(graph, factor, marginals);
  if (!whitened) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> own(whitened->solved);
  const Eigen::VectorXd error = own.eigenvectors().transpose() * whitened->error;
  Innovation innovation;
  for (Eigen::Index k = 0; k < error.size(); ++k) {
    const double share = 1.0 - own.eigenvalues()[k];
    if (share < kLeastShare) continue;
    innovation.chi2 += error[k] * error[k] / share;
    innovation.redundancy += share;
    ++innovation.dimension;
  }
  return innovation;
}

std::optional<Innovation> innovation_outside(const Graph& graph, FactorRef factor,
                                             const Marginals& marginals) {
  const auto whitened = whiten(graph, factor, marginals);
  if (!whitened) return std::nullopt;
  const auto dimension = whitened->error.size();
  const Eigen::MatrixXd both = Eigen::MatrixXd::Identity(dimension, dimension) + whitened->solved;
  const Eigen::MatrixXd shares = both.ldlt().solve(Eigen::MatrixXd::Identity(dimension, dimension));
  return Innovation{whitened->error.dot(shares * whitened->error), static_cast<int>(dimension),
                    shares.trace()};
}

}  // namespace cairn
