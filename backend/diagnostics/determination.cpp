// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/determination.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

namespace cairn {
namespace {

constexpr int kMaxTangent = 6;
constexpr std::size_t kPlace =
    kMaxTangent * kMaxTangent + kMaxTangent;  // a block H_kk and its gradient

// H_kk of every variable, summed over its factors.
struct DiagonalBlocks {
  std::vector<std::array<double, kMaxTangent * kMaxTangent>> block;  // column-major, packed d x d
  std::vector<std::uint32_t> factors;
};

// The batch writes one chunk of factors at a time into `buffer`: memory does not grow with the
// number of factors' blocks, only with their places.
void accumulate(const Graph& graph, const FactorBatch& batch, DiagonalBlocks& blocks) {
  constexpr std::size_t kChunk = 1024;
  const std::size_t arity = batch.signature().size();
  std::vector<double> buffer(kChunk * arity * kPlace);
  std::vector<std::size_t> places(batch.size() * arity);
  for (std::size_t p = 0; p < places.size(); ++p) places[p] = p % (kChunk * arity) * kPlace;
  const std::vector<NormalEquationTargets::OffDiagonal> skipped(
      batch.size() * arity * (arity - 1) / 2, {.offset = NormalEquationTargets::kSkip});
  const NormalEquationTargets targets{.diagonal = buffer.data(),
                                      .diagonal_offset = places.data(),
                                      .blocks = nullptr,
                                      .off_diagonal = skipped.data()};
  const EvaluationContext context{.values = graph.values()};
  for (std::size_t begin = 0; begin < batch.size(); begin += kChunk) {
    const std::size_t end = std::min(begin + kChunk, batch.size());
    batch.linearize(begin, end, context, targets);
    for (std::size_t p = begin * arity; p < end * arity; ++p) {
      const VariableType type = batch.signature()[p % arity];
      const VariableSlot slot = graph.slot_of(type, batch.variable_indices()[p]);
      const int size = tangent_dimension(type) * tangent_dimension(type);
      for (int n = 0; n < size; ++n) blocks.block[slot][n] += buffer[places[p] + n];
      ++blocks.factors[slot];
    }
  }
}

// Directions in which H is zero up to rounding. Rows and columns are scaled to a unit diagonal
// first, so that the answer does not depend on metres against radians.
Eigen::MatrixXd null_space(const Eigen::MatrixXd& H) {
  const Eigen::Index d = H.rows();
  if (H.diagonal().maxCoeff() <= 0.0) return Eigen::MatrixXd::Identity(d, d);
  const double largest = H.diagonal().maxCoeff();
  Eigen::VectorXd scale(d);
  for (Eigen::Index k = 0; k < d; ++k)
    scale[k] = 1.0 / std::sqrt(H(k, k) > 1e-24 * largest ? H(k, k) : largest);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * H *
                                                             scale.asDiagonal());
  constexpr double kRounding = 1e-12;  // a few hundred sums of rounded products of order one
  Eigen::Index free = 0;
  while (free < d && eigen.eigenvalues()[free] < kRounding) ++free;
  Eigen::MatrixXd directions = scale.asDiagonal() * eigen.eigenvectors().leftCols(free);
  for (Eigen::Index c = 0; c < free;
       ++c) {  // scaling tilted the columns: make them orthonormal again
    for (Eigen::Index b = 0; b < c; ++b)
      directions.col(c) -= directions.col(b).dot(directions.col(c)) * directions.col(b);
    directions.col(c).normalize();
  }
  return directions;
}

}  // namespace

std::vector<UndeterminedVariable> find_undetermined_variables(const Graph& graph) {
  const auto variables = graph.variables();
  DiagonalBlocks blocks{
      std::vector<std::array<double, kMaxTangent * kMaxTangent>>(variables.size()),
      std::vector<std::uint32_t>(variables.size())};
  for (const auto& batch : graph.batches()) accumulate(graph, *batch, blocks);
  std::vector<UndeterminedVariable> undetermined;
  for (VariableSlot slot = 0; slot < variables.size(); ++slot) {
    if (variables[slot].fixed) continue;
    const int d = tangent_dimension(variables[slot].type);
    const Eigen::Map<const Eigen::MatrixXd> H(blocks.block[slot].data(), d, d);
    if (!H.allFinite()) continue;
    Eigen::MatrixXd directions = null_space(H);
    if (directions.cols() > 0)
      undetermined.push_back({slot, blocks.factors[slot], std::move(directions)});
  }
  return undetermined;
}

}  // namespace cairn
