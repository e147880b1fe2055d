// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "cairn/core/parallel.hpp"
#include "cairn/linear/block_pattern.hpp"
#include "cairn/linear/elimination_cache.hpp"
#include "cairn/solver/problem.hpp"

namespace cairn {

/// The unknowns of a problem as blocks of a symmetric matrix, in elimination order. Built once per
/// pattern.
struct UnknownLayout {
  explicit UnknownLayout(const Problem& problem, EliminationCache* cache = nullptr);

  std::vector<int> block_of_slot;  ///< in elimination order, -1 for variables that are held
  std::vector<int> slot_of_block;
  BlockGraph blocks;            ///< numbered in slot order
  Elimination elimination;      ///< of `blocks`
  double iteration_work = 0.0;  ///< multiplications of one linearization and factorization
};

/// H dx = -g at a linearization point: H = sum J^T Omega J, g = sum J^T Omega e. Structure once,
/// numbers many times.
class NormalEquations {
 public:
  NormalEquations(const Problem& problem, const UnknownLayout& layout);

  /// Linearizes all factors in use. The same bits for any number of threads.
  RangeCost linearize(const EvaluationContext& context, ThreadPool& pool);
  /// The cost alone.
  RangeCost evaluate_cost(const EvaluationContext& context, ThreadPool& pool);

  /// Makes values() those of H + lambda * diag(H).
  void set_damping(double lambda);
  /// `to` = `from` [+] dx for the unknowns; held variables are copied. dx in elimination order.
  void retract(const Values& from, const Eigen::VectorXd& dx, Values& to) const;

  [[nodiscard]] const BlockPattern& pattern() const { return pattern_; }
  [[nodiscard]] const double* values() const { return values_.data(); }
  [[nodiscard]] const Eigen::VectorXd& gradient() const { return gradient_; }
  /// The undamped diagonal of H.
  [[nodiscard]] const Eigen::VectorXd& diagonal() const { return diagonal_; }
  /// False where a factor's derivatives overflow or are not numbers.
  [[nodiscard]] bool is_finite() const { return gradient_.allFinite() && diagonal_.allFinite(); }
  [[nodiscard]] const UnknownLayout& layout() const { return layout_; }
  [[nodiscard]] const Problem& problem() const { return problem_; }

 private:
  struct Chunk {
    std::uint32_t batch;
    std::size_t begin, end;
  };
  struct BatchTargets {
    std::vector<std::size_t> diagonal_offset;
    std::vector<NormalEquationTargets::OffDiagonal> off_diagonal;
  };
  struct RepeatedBlock {  // a second factor between the same variables: computed aside, then added
    std::size_t source;
    NormalEquationTargets::OffDiagonal target;
    int rows, columns;
  };

  struct Gather {  // what is summed to one diagonal block and its gradient: a part of the scratch
    int block;
    std::size_t begin, end;
  };

  void order_chunks();
  void place_diagonals();
  void place_off_diagonals();
  NormalEquationTargets::OffDiagonal place_block(int block_k, int block_l,
                                                 std::vector<bool>& taken);
  void add_repeated_blocks();
  void gather(const Gather& from);
  void stiffen(const Problem::Anchor& anchor);
  template <class Evaluate>
  RangeCost sum_chunks(ThreadPool& pool, Evaluate evaluate);

  const Problem& problem_;
  const UnknownLayout& layout_;
  BlockPattern pattern_;
  std::vector<BatchTargets> targets_;
  std::vector<RepeatedBlock> repeated_;
  std::vector<Chunk> chunks_;
  std::vector<std::uint32_t> chunk_order_;  // as they are shared out
  std::vector<RangeCost> chunk_costs_;
  std::vector<double> values_;         // pattern values, then the repeated blocks
  std::unique_ptr<double[]> scratch_;  // H_kk and g_k of every factor, those of a block together
  std::vector<Gather> gathers_;        // in slot order
  Eigen::VectorXd gradient_;
  Eigen::VectorXd diagonal_;
  double damping_ = 0.0;  // in values_
};

}  // namespace cairn
