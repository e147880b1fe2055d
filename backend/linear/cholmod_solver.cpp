// SPDX-License-Identifier: BSD-3-Clause
#include <cholmod.h>

#include <algorithm>
#include <numeric>

#include "cairn/core/check.hpp"
#include "cairn/linear/linear_solver.hpp"
#include "cairn/linear/scalar_matrix.hpp"
#include "cairn/linear/single_thread_blas.hpp"

namespace cairn {
namespace {

class CholmodSolver final : public LinearSolver {
 public:
  CholmodSolver() {
    cholmod_start(&common_);
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_NATURAL;  // the pattern already is in elimination order
    common_.postorder = 0;
    common_.final_ll = 1;
    common_.print = 0;
#ifdef CAIRN_WITH_GPL
    common_.supernodal = CHOLMOD_AUTO;  // by operations per non-zero of the factor
#else
    common_.supernodal = CHOLMOD_SIMPLICIAL;
#endif
  }

  ~CholmodSolver() override {
    cholmod_free_dense(&x_, &common_);
    cholmod_free_dense(&y_workspace_, &common_);
    cholmod_free_dense(&e_workspace_, &common_);
    cholmod_free_factor(&factor_, &common_);
    cholmod_finish(&common_);
  }

  void analyze(const BlockPattern& pattern, const Elimination& /*elimination*/) override {
    const SingleThreadBlas single_thread;
    scalar_ = ScalarPattern::lower(pattern);
    matrix_ = view_of(scalar_);
    factor_ = cholmod_analyze(&matrix_, &common_);
    CAIRN_CHECK(factor_ != nullptr, "CHOLMOD could not analyze the pattern (out of memory?)");
  }

  bool factorize(const double* values) override {
    const SingleThreadBlas single_thread;
    matrix_.x = const_cast<double*>(values);
    matrix_.xtype = CHOLMOD_REAL;
    if (cholmod_factorize(&matrix_, factor_, &common_) == 0) return false;
    return common_.status == CHOLMOD_OK && factor_->minor == factor_->n;
  }

  void solve(const double* b, double* x) override {
    const SingleThreadBlas single_thread;
    const std::size_t n = factor_->n;
    cholmod_dense rhs{n, 1, n, n, const_cast<double*>(b), nullptr, CHOLMOD_REAL, CHOLMOD_DOUBLE};
    const int ok = cholmod_solve2(CHOLMOD_A, factor_, &rhs, nullptr, &x_, nullptr, &y_workspace_,
                                  &e_workspace_, &common_);
    CAIRN_CHECK(ok, "CHOLMOD could not solve (out of memory?)");
    std::copy_n(static_cast<const double*>(x_->x), n, x);
  }

  [[nodiscard]] std::optional<std::int64_t> factor_nonzeros() const override {
    if (factor_->is_super != 0) return static_cast<std::int64_t>(factor_->xsize);
    const int* count = static_cast<const int*>(factor_->ColCount);
    return std::accumulate(count, count + factor_->n, std::int64_t{0});
  }

  [[nodiscard]] std::optional<SupernodalFactor> factor() const override {
    const std::size_t n = factor_->n;
    if (factor_->is_super != 0) {
      const std::size_t count = factor_->nsuper + 1;
      const int* px = static_cast<const int*>(factor_->px);
      panel_begin_.assign(px, px + count);
      return SupernodalFactor{{static_cast<const int*>(factor_->super), count},
                              {static_cast<const int*>(factor_->pi), count},
                              panel_begin_,
                              {static_cast<const int*>(factor_->s), factor_->ssize},
                              static_cast<const double*>(factor_->x)};
    }
    if (columns_.size() != n + 1) {
      columns_.resize(n + 1);
      std::iota(columns_.begin(), columns_.end(), 0);
    }
    cholmod_factor* packed = factor_;  // simplicial: every column is a supernode of its own
    cholmod_change_factor(CHOLMOD_REAL, 1, 0, 1, 1, packed, &common_);
    const std::span<const int> p{static_cast<const int*>(packed->p), n + 1};
    panel_begin_.assign(p.begin(), p.end());
    return SupernodalFactor{columns_,
                            p,
                            panel_begin_,
                            {static_cast<const int*>(packed->i), packed->nzmax},
                            static_cast<const double*>(packed->x)};
  }

 private:
  static cholmod_sparse view_of(ScalarPattern& scalar) {
    cholmod_sparse matrix{};
    matrix.nrow = matrix.ncol = scalar.begin.size() - 1;
    matrix.nzmax = scalar.row.size();
    matrix.p = scalar.begin.data();
    matrix.i = scalar.row.data();
    matrix.stype = -1;  // the rows above the diagonal inside diagonal blocks are ignored
    matrix.itype = CHOLMOD_INT;
    matrix.xtype = CHOLMOD_PATTERN;  // until there are values
    matrix.sorted = matrix.packed = 1;
    return matrix;
  }

  mutable cholmod_common common_{};
  ScalarPattern scalar_;
  cholmod_sparse matrix_{};
  cholmod_factor* factor_ = nullptr;
  cholmod_dense* x_ = nullptr;
  cholmod_dense* y_workspace_ = nullptr;
  cholmod_dense* e_workspace_ = nullptr;
  mutable std::vector<int> columns_;
  mutable std::vector<std::size_t> panel_begin_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_cholmod_solver() { return std::make_unique<CholmodSolver>(); }

}  // namespace cairn
