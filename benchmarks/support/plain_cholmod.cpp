// SPDX-License-Identifier: BSD-3-Clause
#include "benchmarks/support/plain_cholmod.hpp"

#include <cholmod.h>

#include <algorithm>

#include "cairn/core/check.hpp"
#include "cairn/linear/scalar_matrix.hpp"

namespace cairn::bench {
namespace {

class PlainCholmod final : public LinearSolver {
 public:
  PlainCholmod() {
    cholmod_start(&common_);
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_NATURAL;
    common_.postorder = 0;
    common_.final_ll = 1;
    common_.print = 0;
  }

  ~PlainCholmod() override {
    cholmod_free_dense(&x_, &common_);
    cholmod_free_dense(&y_workspace_, &common_);
    cholmod_free_dense(&e_workspace_, &common_);
    cholmod_free_factor(&factor_, &common_);
    cholmod_finish(&common_);
  }

  void analyze(const BlockPattern& pattern, const Elimination& /*elimination*/) override {
    scalar_ = ScalarPattern::lower(pattern);
    matrix_ = {};
    matrix_.nrow = matrix_.ncol = scalar_.begin.size() - 1;
    matrix_.nzmax = scalar_.row.size();
    matrix_.p = scalar_.begin.data();
    matrix_.i = scalar_.row.data();
    matrix_.stype = -1;
    matrix_.itype = CHOLMOD_INT;
    matrix_.xtype = CHOLMOD_PATTERN;
    matrix_.sorted = matrix_.packed = 1;
    cholmod_free_factor(&factor_, &common_);
    factor_ = cholmod_analyze(&matrix_, &common_);
    CAIRN_CHECK(factor_ != nullptr, "CHOLMOD could not analyze the pattern");
  }

  bool factorize(const double* values) override {
    matrix_.x = const_cast<double*>(values);
    matrix_.xtype = CHOLMOD_REAL;
    if (cholmod_factorize(&matrix_, factor_, &common_) == 0) return false;
    return common_.status == CHOLMOD_OK && factor_->minor == factor_->n;
  }

  void solve(const double* b, double* x) override {
    const std::size_t n = factor_->n;
    cholmod_dense rhs{n, 1, n, n, const_cast<double*>(b), nullptr, CHOLMOD_REAL, CHOLMOD_DOUBLE};
    const int ok = cholmod_solve2(CHOLMOD_A, factor_, &rhs, nullptr, &x_, nullptr, &y_workspace_,
                                  &e_workspace_, &common_);
    CAIRN_CHECK(ok, "CHOLMOD could not solve");
    std::copy_n(static_cast<const double*>(x_->x), n, x);
  }

 private:
  cholmod_common common_{};
  ScalarPattern scalar_;
  cholmod_sparse matrix_{};
  cholmod_factor* factor_ = nullptr;
  cholmod_dense* x_ = nullptr;
  cholmod_dense* y_workspace_ = nullptr;
  cholmod_dense* e_workspace_ = nullptr;
};

}  // namespace

std::unique_ptr<LinearSolver> make_plain_cholmod() { return std::make_unique<PlainCholmod>(); }

}  // namespace cairn::bench
