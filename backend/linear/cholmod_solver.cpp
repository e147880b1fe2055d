// SPDX-License-Identifier: BSD-3-Clause
#include <cholmod.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "cairn/core/check.hpp"
#include "cairn/linear/linear_solver.hpp"
#include "cairn/linear/scalar_matrix.hpp"
#include "cairn/linear/single_thread_blas.hpp"

namespace cairn {
namespace {

// What CHOLMOD's own analysis would find again, scalar by scalar, we know from the elimination of
// blocks: the tree and the length of each column. Its factor takes both as they are.
class CholmodSolver final : public LinearSolver {
 public:
  CholmodSolver() {
    cholmod_start(&common_);
    common_.final_ll = 1;
    common_.print = 0;
  }

  ~CholmodSolver() override {
    cholmod_free_dense(&x_, &common_);
    cholmod_free_dense(&y_workspace_, &common_);
    cholmod_free_dense(&e_workspace_, &common_);
    cholmod_free_factor(&factor_, &common_);
    cholmod_finish(&common_);
  }

  void analyze(const BlockPattern& pattern, const Elimination& elimination) override {
    const SingleThreadBlas single_thread;
    BlockRows rows(pattern);
    factor_ = cholmod_allocate_factor(static_cast<std::size_t>(pattern.scalar_size()), &common_);
    CAIRN_CHECK(factor_ != nullptr, "CHOLMOD could not allocate its factor (out of memory?)");
    count_columns(pattern, factor_heights(pattern, rows, elimination.parent));
#ifdef CAIRN_WITH_GPL
    if (supernodes_pay()) {
      find_supernodes(pattern, rows, elimination.parent);
      lower_ = ScalarPattern::lower(pattern);
      matrix_ = view_of(lower_.begin, lower_.row, -1);
      return;
    }
#endif
    upper_.emplace(pattern, std::move(rows));
    matrix_ = view_of(upper_->begin, upper_->row, 1);
  }

  bool factorize(const double* values) override {
    const SingleThreadBlas single_thread;
    if (upper_) upper_->take(values);
    matrix_.x = upper_ ? upper_->values.data() : const_cast<double*>(values);
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
  void count_columns(const BlockPattern& pattern, std::span<const int> heights) {
    int* count = static_cast<int*>(factor_->ColCount);
    for (int j = 0; j < pattern.size(); ++j) {
      for (int c = 0; c < pattern.dimension[j]; ++c) *count++ = heights[j] - c;
    }
  }

#ifdef CAIRN_WITH_GPL
  // CHOLMOD's own rule: by operations per number of the factor.
  [[nodiscard]] bool supernodes_pay() const {
    const int* count = static_cast<const int*>(factor_->ColCount);
    double numbers = 0.0, operations = 0.0;
    for (std::size_t j = 0; j < factor_->n; ++j) {
      numbers += count[j];
      operations += static_cast<double>(count[j]) * count[j];
    }
    return numbers > 0.0 && operations >= common_.supernodal_switch * numbers;
  }

  // CHOLMOD walks up the tree from each number above the diagonal: one in each block is enough.
  void find_supernodes(const BlockPattern& pattern, const BlockRows& rows,
                       std::span<const int> block_parent) {
    std::vector<int> begin{0}, row, parent;
    for (int i = 0; i < pattern.size(); ++i) {
      const int above = block_parent[i];
      for (int c = 0; c < pattern.dimension[i]; ++c) {
        for (int k = rows.begin[i]; k < rows.begin[i + 1]; ++k)
          row.push_back(pattern.scalar_begin[rows.column[k]]);
        begin.push_back(static_cast<int>(row.size()));
        parent.push_back(pattern.scalar_begin[i] + c + 1);
      }
      parent.back() = above < 0 ? -1 : pattern.scalar_begin[above];
    }
    cholmod_sparse matrix = view_of(begin, row, 1);
    const int ok = cholmod_super_symbolic(&matrix, nullptr, parent.data(), factor_, &common_);
    CAIRN_CHECK(ok, "CHOLMOD could not find its supernodes (out of memory?)");
  }
#endif

  static cholmod_sparse view_of(std::vector<int>& begin, std::vector<int>& row, int triangle) {
    cholmod_sparse matrix{};
    matrix.nrow = matrix.ncol = begin.size() - 1;
    matrix.nzmax = row.size();
    matrix.p = begin.data();
    matrix.i = row.data();
    matrix.stype = triangle;  // 1: upper, -1: lower; what is in the other is ignored
    matrix.itype = CHOLMOD_INT;
    matrix.xtype = CHOLMOD_PATTERN;  // until there are values
    matrix.sorted = matrix.packed = 1;
    return matrix;
  }

  mutable cholmod_common common_{};
  ScalarPattern lower_;               // supernodes take the pattern's values as they are,
  std::optional<UpperMatrix> upper_;  // single columns want the other triangle
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
