// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/normal_equations.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cairn {
namespace {

// Fixed sizes: sums over chunks must not depend on the number of threads.
constexpr std::size_t kFactorsPerChunk = 64;
constexpr std::size_t kBlocksPerChunk = 32;

constexpr std::size_t scratch_size(int dimension) {
  return static_cast<std::size_t>(dimension) * (static_cast<std::size_t>(dimension) + 1);
}

std::vector<int> block_dimensions(const Problem& problem, const UnknownLayout& layout) {
  std::vector<int> dimensions(layout.slot_of_block.size());
  for (std::size_t j = 0; j < dimensions.size(); ++j) {
    dimensions[j] = tangent_dimension(problem.graph->variables()[layout.slot_of_block[j]].type);
  }
  return dimensions;
}

// Blocks have few sizes: the mean one stands for all.
double count_iteration_work(const Problem& problem, const UnknownLayout& layout) {
  constexpr double kProductsPerFactor = 4.0;  // J^T Omega J of each pair of ends
  double work = 0.0, dimensions = 0.0;
  for (const auto& batch : problem.batches)
    work += kProductsPerFactor * static_cast<double>(batch->size()) *
            std::pow(batch->residual_dimension(), 3);
  for (const int dimension : block_dimensions(problem, layout)) dimensions += dimension;
  const double size = std::max<double>(1.0, static_cast<double>(layout.slot_of_block.size()));
  return work + layout.elimination.block_operations() * std::pow(dimensions / size, 3);
}

// H_v += contributions of all factors on v, in factor order; then the gradient likewise.
template <int d>
void sum_contributions(const double* first, const double* last, double* block,
                       int leading_dimension, double* g, double* diagonal) {
  using Contribution = Eigen::Matrix<double, d*(d + 1), 1>;
  Contribution sum;
  if (first == last) {
    sum.setZero();
  } else {
    sum = Eigen::Map<const Contribution>(first);
    for (first += sum.size(); first != last; first += sum.size())
      sum += Eigen::Map<const Contribution>(first);
  }
  for (int column = 0; column < d; ++column) {
    for (int row = 0; row < d; ++row)
      block[column * leading_dimension + row] = sum[column * d + row];
    g[column] = sum[d * d + column];
    diagonal[column] = sum[column * d + column];
  }
}

}  // namespace

UnknownLayout::UnknownLayout(const Problem& problem, EliminationCache* cache)
    : block_of_slot(problem.held.size(), -1) {
  std::vector<int> unknown_slots;
  for (std::size_t slot = 0; slot < problem.held.size(); ++slot) {
    if (problem.held[slot]) continue;
    block_of_slot[slot] = static_cast<int>(unknown_slots.size());
    unknown_slots.push_back(static_cast<int>(slot));
  }
  std::vector<std::pair<int, int>> pairs = problem.coupled_slots();
  std::size_t kept = 0;
  for (const auto& [k, l] : pairs) {
    if (block_of_slot[k] >= 0 && block_of_slot[l] >= 0)
      pairs[kept++] = {block_of_slot[k], block_of_slot[l]};
  }
  pairs.resize(kept);
  blocks = BlockGraph::from_pairs(static_cast<int>(unknown_slots.size()), pairs);
  elimination = cache == nullptr ? find_elimination(blocks) : cache->find(blocks);
  slot_of_block.resize(unknown_slots.size());
  for (std::size_t i = 0; i < unknown_slots.size(); ++i) {
    const int position = elimination.position[i];
    block_of_slot[unknown_slots[i]] = position;
    slot_of_block[position] = unknown_slots[i];
  }
  iteration_work = count_iteration_work(problem, *this);
}

NormalEquations::NormalEquations(const Problem& problem, const UnknownLayout& layout)
    : problem_(problem), layout_(layout) {
  const std::vector<int> ordered = block_dimensions(problem, layout);
  std::vector<int> dimensions(ordered.size());
  for (std::size_t i = 0; i < ordered.size(); ++i)
    dimensions[i] = ordered[layout.elimination.position[i]];
  pattern_ = BlockPattern::build(layout.blocks, layout.elimination.position, dimensions);
  values_.resize(pattern_.value_count());
  gradient_.resize(pattern_.scalar_size());
  diagonal_.resize(pattern_.scalar_size());
  targets_.resize(problem.batches.size());
  for (std::size_t b = 0; b < problem.batches.size(); ++b) {
    const std::size_t size = problem.batches[b]->size();
    for (std::size_t begin = 0; begin < size; begin += kFactorsPerChunk) {
      chunks_.push_back(
          {static_cast<std::uint32_t>(b), begin, std::min(size, begin + kFactorsPerChunk)});
    }
  }
  chunk_costs_.resize(chunks_.size());
  order_chunks();
  place_diagonals();
  place_off_diagonals();
}

// Factors near in time share variables, so a thread that takes neighbours finds them in its cache.
void NormalEquations::order_chunks() {
  std::vector<double> mean_slot;
  for (const Chunk& chunk : chunks_) {
    const FactorBatch& batch = *problem_.batches[chunk.batch];
    const auto signature = batch.signature();
    const auto indices = batch.variable_indices();
    double sum = 0.0;
    for (std::size_t i = chunk.begin * signature.size(); i < chunk.end * signature.size(); ++i)
      sum +=
          static_cast<double>(problem_.graph->slot_of(signature[i % signature.size()], indices[i]));
    mean_slot.push_back(sum / static_cast<double>((chunk.end - chunk.begin) * signature.size()));
  }
  chunk_order_.resize(chunks_.size());
  std::iota(chunk_order_.begin(), chunk_order_.end(), 0U);
  std::stable_sort(chunk_order_.begin(), chunk_order_.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return mean_slot[a] < mean_slot[b]; });
}

void NormalEquations::place_diagonals() {
  std::vector<std::size_t> count(static_cast<std::size_t>(pattern_.size()), 0);
  for (std::size_t b = 0; b < targets_.size();
       ++b) {  // first: the block of each factor's variables
    const FactorBatch& batch = *problem_.batches[b];
    const auto signature = batch.signature();
    const auto indices = batch.variable_indices();
    std::vector<std::size_t>& offsets = targets_[b].diagonal_offset;
    offsets.resize(indices.size());
    for (std::size_t i = 0; i < indices.size(); ++i) {
      const int block =
          layout_
              .block_of_slot[problem_.graph->slot_of(signature[i % signature.size()], indices[i])];
      offsets[i] = block < 0 ? NormalEquationTargets::kSkip : static_cast<std::size_t>(block);
      if (block >= 0) ++count[block];
    }
  }
  std::vector<std::size_t> next(count.size());
  std::size_t size = 0;
  for (const int j : layout_.block_of_slot) {
    if (j < 0) continue;
    next[j] = size;
    size += count[j] * scratch_size(pattern_.dimension[j]);
    gathers_.push_back({j, next[j], size});
  }
  scratch_ = std::make_unique_for_overwrite<double[]>(size);
  for (BatchTargets& targets : targets_) {  // then: its own place among the block's contributions
    for (std::size_t& offset : targets.diagonal_offset) {
      if (offset == NormalEquationTargets::kSkip) continue;
      const std::size_t block = offset;
      offset = next[block];
      next[block] += scratch_size(pattern_.dimension[block]);
    }
  }
}

void NormalEquations::place_off_diagonals() {
  std::vector<bool> taken(pattern_.row.size(), false);
  for (std::size_t b = 0; b < targets_.size(); ++b) {
    const FactorBatch& batch = *problem_.batches[b];
    const auto signature = batch.signature();
    const auto indices = batch.variable_indices();
    const std::size_t arity = signature.size();
    targets_[b].off_diagonal.reserve(batch.size() * arity * (arity - 1) / 2);
    const auto block_of = [&](std::size_t i, std::size_t k) {
      return layout_.block_of_slot[problem_.graph->slot_of(signature[k], indices[i * arity + k])];
    };
    for (std::size_t i = 0; i < batch.size(); ++i) {
      for (std::size_t k = 0; k < arity; ++k) {
        for (std::size_t l = k + 1; l < arity; ++l) {
          targets_[b].off_diagonal.push_back(place_block(block_of(i, k), block_of(i, l), taken));
        }
      }
    }
  }
}

NormalEquationTargets::OffDiagonal NormalEquations::place_block(int block_k, int block_l,
                                                                std::vector<bool>& taken) {
  if (block_k < 0 || block_l < 0) return {};
  const bool transposed = block_k < block_l;  // the lower triangle has H_lk = H_kl^T
  const int column = std::min(block_k, block_l);
  const int entry = pattern_.find(std::max(block_k, block_l), column);
  const NormalEquationTargets::OffDiagonal place{
      pattern_.value_begin[column] + static_cast<std::size_t>(pattern_.row_offset[entry]),
      pattern_.height[column], transposed};
  if (!taken[entry]) {
    taken[entry] = true;
    return place;
  }
  const int rows = pattern_.dimension[pattern_.row[entry]], columns = pattern_.dimension[column];
  const std::size_t aside = values_.size();
  values_.resize(aside + static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns));
  repeated_.push_back({aside, place, rows, columns});
  return {aside, rows, transposed};
}

template <class Evaluate>
RangeCost NormalEquations::sum_chunks(ThreadPool& pool, Evaluate evaluate) {
  pool.run(chunks_.size(), [&](std::size_t i) {
    const std::uint32_t c = chunk_order_[i];
    chunk_costs_[c] = evaluate(chunks_[c]);
  });
  RangeCost sum;
  for (const RangeCost& cost : chunk_costs_) {
    sum.chi2 += cost.chi2;
    sum.cost += cost.cost;
  }
  return sum;
}

RangeCost NormalEquations::linearize(const EvaluationContext& context, ThreadPool& pool) {
  const RangeCost sum = sum_chunks(pool, [&](const Chunk& chunk) {
    const BatchTargets& targets = targets_[chunk.batch];
    return problem_.batches[chunk.batch]->linearize(chunk.begin, chunk.end, context,
                                                    {scratch_.get(), targets.diagonal_offset.data(),
                                                     values_.data(), targets.off_diagonal.data()});
  });
  add_repeated_blocks();
  pool.run((gathers_.size() + kBlocksPerChunk - 1) / kBlocksPerChunk, [&](std::size_t c) {
    const std::size_t begin = c * kBlocksPerChunk;
    const std::size_t end = std::min(gathers_.size(), begin + kBlocksPerChunk);
    for (std::size_t i = begin; i < end; ++i) gather(gathers_[i]);
  });
  for (const Problem::Anchor& anchor : problem_.anchors) stiffen(anchor);
  damping_ = 0.0;
  return sum;
}

RangeCost NormalEquations::evaluate_cost(const EvaluationContext& context, ThreadPool& pool) {
  return sum_chunks(pool, [&](const Chunk& chunk) {
    return problem_.batches[chunk.batch]->evaluate_cost(chunk.begin, chunk.end, context);
  });
}

void NormalEquations::add_repeated_blocks() {
  for (const RepeatedBlock& block : repeated_) {
    for (int column = 0; column < block.columns; ++column) {
      double* target = values_.data() + block.target.offset +
                       static_cast<std::size_t>(column) *
                           static_cast<std::size_t>(block.target.leading_dimension);
      const double* source =
          values_.data() + block.source + static_cast<std::size_t>(column * block.rows);
      for (int row = 0; row < block.rows; ++row) target[row] += source[row];
    }
  }
}

void NormalEquations::gather(const Gather& from) {
  const auto [block, begin, end] = from;
  const double* first = scratch_.get() + begin;
  const double* last = scratch_.get() + end;
  double* target = values_.data() + pattern_.value_begin[block];
  const int height = pattern_.height[block], scalar = pattern_.scalar_begin[block];
  double* g = gradient_.data() + scalar;
  double* diagonal = diagonal_.data() + scalar;
  switch (pattern_.dimension[block]) {
    case 2:
      sum_contributions<2>(first, last, target, height, g, diagonal);
      break;
    case 3:
      sum_contributions<3>(first, last, target, height, g, diagonal);
      break;
    default:
      sum_contributions<6>(first, last, target, height, g, diagonal);
      break;
  }
}

// Stiffness where nothing is measured leaves the minimum where it is and the matrix regular.
void NormalEquations::stiffen(const Problem::Anchor& anchor) {
  const int j = layout_.block_of_slot[anchor.slot];
  if (j < 0) return;
  const int d = pattern_.dimension[j], first = pattern_.scalar_begin[j];
  const double stiffness = std::max(diagonal_.segment(first, d).maxCoeff(), 1.0);
  Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>> block(
      values_.data() + pattern_.value_begin[j], d, d, Eigen::OuterStride<>(pattern_.height[j]));
  block += stiffness * anchor.directions * anchor.directions.transpose();
  diagonal_.segment(first, d) = block.diagonal();
}

void NormalEquations::set_damping(double lambda) {
  if (lambda == damping_) return;
  damping_ = lambda;
  for (int j = 0; j < pattern_.size(); ++j) {
    double* block = values_.data() + pattern_.value_begin[j];
    for (int k = 0; k < pattern_.dimension[j]; ++k) {
      block[k * (pattern_.height[j] + 1)] =
          diagonal_[pattern_.scalar_begin[j] + k] * (1.0 + lambda);
    }
  }
}

void NormalEquations::retract(const Values& from, const Eigen::VectorXd& dx, Values& to) const {
  to = from;
  for (int j = 0; j < pattern_.size(); ++j) {
    const Variable& variable = problem_.graph->variables()[layout_.slot_of_block[j]];
    to.retract(variable.type, variable.index, dx.data() + pattern_.scalar_begin[j]);
  }
}

}  // namespace cairn
