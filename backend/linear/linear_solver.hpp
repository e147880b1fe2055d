// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "cairn/linear/block_pattern.hpp"
#include "cairn/linear/elimination.hpp"
#include "cairn/linear/kernel.hpp"

namespace cairn {

/// A read-only view of a Cholesky factor L (A = L L^T) in supernodal storage. Supernode k holds the
/// columns super[k] .. super[k + 1) over the rows s[pi[k] .. pi[k + 1]), ascending, its own columns
/// first, as one dense column-major panel x[px[k] ..] whose leading dimension is the number of
/// rows. Above the diagonal of the first rows the panel holds no meaning.
struct SupernodalFactor {
  std::span<const int> super;
  std::span<const int> pi;
  std::span<const std::size_t> px;
  std::span<const int> s;
  const double* x = nullptr;

  [[nodiscard]] int supernodes() const { return static_cast<int>(super.size()) - 1; }
  [[nodiscard]] int columns(int k) const { return super[k + 1] - super[k]; }
  [[nodiscard]] int rows(int k) const { return pi[k + 1] - pi[k]; }
  [[nodiscard]] double diagonal(int k, int column) const {
    return x[px[k] + static_cast<std::size_t>(column) * (rows(k) + 1)];
  }
};

/// Solves A x = b for symmetric positive definite A: one pattern, many values. Knows nothing of
/// poses. One thread.
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;

  /// Prepares for a pattern, which must outlive the solver. Called once, first.
  virtual void analyze(const BlockPattern& pattern, const Elimination& elimination) = 0;
  /// Takes the values of the pattern. False when A is not positive definite; another factorize may
  /// follow.
  [[nodiscard]] virtual bool factorize(const double* values) = 0;
  /// x = A^-1 b with the values of the last successful factorize; b and x (pattern.scalar_size())
  /// may be the same.
  virtual void solve(const double* b, double* x) = 0;

  /// Numbers stored in the factor; nothing for methods without one.
  [[nodiscard]] virtual std::optional<std::int64_t> factor_nonzeros() const { return std::nullopt; }
  /// The factor of the last successful factorize; nothing for methods without one.
  [[nodiscard]] virtual std::optional<SupernodalFactor> factor() const { return std::nullopt; }
};

/// Our own Cholesky, by dense fronts of blocks: two to six times faster than CHOLMOD's on these
/// matrices. The kernel must be runnable.
std::unique_ptr<LinearSolver> make_multifrontal_solver(Kernel kernel = Kernel::kFastest);
/// CHOLMOD on our order and our analysis: column by column or by supernodes, by its own rule;
/// column by column when built without its GPL module.
std::unique_ptr<LinearSolver> make_cholmod_solver();
/// Eigen's simplicial L D L^T.
std::unique_ptr<LinearSolver> make_eigen_solver();
/// Conjugate gradients, preconditioned with the inverse diagonal blocks.
std::unique_ptr<LinearSolver> make_pcg_solver();

}  // namespace cairn
