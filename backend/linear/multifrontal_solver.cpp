// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>

#include "cairn/core/check.hpp"
#include "cairn/linear/front_kernels.hpp"
#include "cairn/linear/linear_solver.hpp"

namespace cairn {
namespace {

// Cholesky by fronts (Duff & Reid 1983; Liu 1992): from the leaves of the tree of supernodes to the
// roots, each supernode collects its part of A and what its children left over into a dense front,
// eliminates its own columns, and leaves the rest to its parent on a stack.
class MultifrontalSolver final : public LinearSolver {
 public:
  explicit MultifrontalSolver(const FrontKernels& kernels) : kernels_(kernels) {}

  void analyze(const BlockPattern& pattern, const Elimination& elimination) override {
    pattern_ = &pattern;
    supernodes_ = elimination.supernodes;
    place_panels();
    place_matrix();
    place_leftovers();
    factor_ = std::make_unique_for_overwrite<double[]>(panel_begin_.back() + kFrontSlack);
    stack_ = std::make_unique_for_overwrite<double[]>(stack_size() + kFrontSlack);
    inverse_ = std::make_unique_for_overwrite<double[]>(pattern.scalar_size());
    front_.resize(static_cast<std::size_t>(largest_front()) + kFrontSlack);
  }

  bool factorize(const double* values) override {
    std::size_t top = 0;  // of the stack: the leftovers of supernodes whose parent is not done
    for (int s = 0; s < supernodes_.size(); ++s) {
      double* panel = factor_.get() + panel_begin_[s];
      const int m = height(s), n = width(s), below = m - n;
      std::fill_n(panel, static_cast<std::size_t>(m) * static_cast<std::size_t>(n), 0.0);
      add_matrix(s, values, panel);
      const std::size_t children = top;
      for (int child = last_child_[s]; child >= 0; child = previous_sibling_[child]) {
        top -= leftover_area(child);
        add_leftover(child, stack_.get() + top, 0, n, panel, m);
      }
      if (!kernels_.factorize_panel(m, n, panel, inverse_.get() + column_begin_[s])) return false;
      if (below == 0) continue;
      double* leftover = stack_.get() + children;
      kernels_.negative_square(m, n, panel, leftover);
      std::size_t place = children;
      for (int child = last_child_[s]; child >= 0; child = previous_sibling_[child]) {
        place -= leftover_area(child);
        add_leftover(child, stack_.get() + place, n, m, leftover, below);
      }
      if (top != children) std::copy_n(leftover, square(below), stack_.get() + top);
      top += square(below);
    }
    return true;
  }

  void solve(const double* b, double* x) override {
    if (b != x) std::copy_n(b, pattern_->scalar_size(), x);
    double* front = front_.data();
    for (int s = 0; s < supernodes_.size(); ++s) {
      const int m = height(s), n = width(s);
      const int* rows = rows_.data() + row_begin_[s];
      gather(x, rows, m, front);
      kernels_.solve_lower(m, n, factor_.get() + panel_begin_[s], inverse_.get() + column_begin_[s],
                           front);
      for (int i = 0; i < m; ++i) x[rows[i]] = front[i];
    }
    for (int s = supernodes_.size() - 1; s >= 0; --s) {
      const int m = height(s), n = width(s);
      gather(x, rows_.data() + row_begin_[s], m, front);
      kernels_.solve_upper(m, n, factor_.get() + panel_begin_[s], inverse_.get() + column_begin_[s],
                           front);
      std::copy_n(front, n, x + column_begin_[s]);
    }
  }

  [[nodiscard]] std::optional<std::int64_t> factor_nonzeros() const override {
    std::int64_t count = 0;
    for (int s = 0; s < supernodes_.size(); ++s) {
      const std::int64_t n = width(s);
      count += n * (n + 1) / 2 + n * (height(s) - n);
    }
    return count;
  }

  [[nodiscard]] std::optional<SupernodalFactor> factor() const override {
    return SupernodalFactor{column_begin_, row_begin_, panel_begin_, rows_, factor_.get()};
  }

 private:
  [[nodiscard]] int height(int s) const { return row_begin_[s + 1] - row_begin_[s]; }
  [[nodiscard]] int width(int s) const { return column_begin_[s + 1] - column_begin_[s]; }
  static std::size_t square(int n) {
    return static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
  }
  [[nodiscard]] std::size_t leftover_area(int s) const { return square(height(s) - width(s)); }
  static void gather(const double* x, const int* rows, int count, double* front) {
    for (int i = 0; i < count; ++i) front[i] = x[rows[i]];
  }

  // Scalar columns, rows and panels of the supernodes.
  void place_panels() {
    const int size = supernodes_.size();
    column_begin_.resize(size + 1);
    row_begin_.assign(size + 1, 0);
    panel_begin_.assign(size + 1, 0);
    for (int s = 0; s <= size; ++s) column_begin_[s] = pattern_->scalar_begin[supernodes_.first[s]];
    for (int s = 0; s < size; ++s) {
      for (int row = column_begin_[s]; row < column_begin_[s + 1]; ++row) rows_.push_back(row);
      for (const int block : supernodes_.rows(s)) {
        for (int k = 0; k < pattern_->dimension[block]; ++k)
          rows_.push_back(pattern_->scalar_begin[block] + k);
      }
      row_begin_[s + 1] = static_cast<int>(rows_.size());
      panel_begin_[s + 1] = panel_begin_[s] + static_cast<std::size_t>(height(s)) *
                                                  static_cast<std::size_t>(width(s));
    }
  }

  // For each supernode, in ascending order of rows: calls visit(k, row of the front) for the blocks
  // `wanted`, which all are among its columns and rows.
  template <class Visit>
  void find_in_front(int s, std::span<const int> wanted, Visit visit) const {
    const std::span<const int> rows = supernodes_.rows(s);
    const int first = supernodes_.first[s], last = supernodes_.first[s + 1];
    int below = width(s);
    std::size_t at = 0;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      if (wanted[k] < last) {
        visit(k, pattern_->scalar_begin[wanted[k]] - pattern_->scalar_begin[first]);
        continue;
      }
      for (; rows[at] != wanted[k]; ++at) below += pattern_->dimension[rows[at]];
      visit(k, below);
    }
  }

  static void append(std::vector<FrontRun>& runs, std::size_t begin, FrontRun run) {
    if (runs.size() > begin && runs.back().from + runs.back().length == run.from &&
        runs.back().to + runs.back().length == run.to)
      runs.back().length += run.length;
    else
      runs.push_back(run);
  }

  // Where each block column of A goes in its supernode's panel.
  void place_matrix() {
    const int n = pattern_->size();
    matrix_run_begin_.assign(n + 1, 0);
    for (int s = 0; s < supernodes_.size(); ++s) {
      for (int j = supernodes_.first[s]; j < supernodes_.first[s + 1]; ++j) {
        const int begin = pattern_->column_begin[j];
        const std::span<const int> blocks(pattern_->row.data() + begin,
                                          pattern_->row.data() + pattern_->column_begin[j + 1]);
        find_in_front(s, blocks, [&](std::size_t k, int row) {
          append(matrix_runs_, matrix_run_begin_[j],
                 {pattern_->row_offset[begin + k], row, pattern_->dimension[blocks[k]]});
        });
        matrix_run_begin_[j + 1] = matrix_runs_.size();
      }
    }
  }

  // Where the rows below each supernode are in its parent's front; children by parent.
  void place_leftovers() {
    const int size = supernodes_.size();
    last_child_.assign(size, -1);
    previous_sibling_.assign(size, -1);
    leftover_run_begin_.assign(size + 1, 0);
    for (int s = 0; s < size; ++s) {
      const int parent = supernodes_.parent[s];
      if (parent >= 0) {
        previous_sibling_[s] = last_child_[parent];
        last_child_[parent] = s;
        const std::span<const int> rows = supernodes_.rows(s);
        int from = 0;
        find_in_front(parent, rows, [&](std::size_t k, int to) {
          append(leftover_runs_, leftover_run_begin_[s], {from, to, pattern_->dimension[rows[k]]});
          from += pattern_->dimension[rows[k]];
        });
      }
      leftover_run_begin_[s + 1] = leftover_runs_.size();
    }
  }

  [[nodiscard]] std::size_t stack_size() const {
    std::size_t top = 0, largest = 0;
    for (int s = 0; s < supernodes_.size(); ++s) {
      const std::size_t area = leftover_area(s);
      largest = std::max(largest, top + area);
      for (int child = last_child_[s]; child >= 0; child = previous_sibling_[child])
        top -= leftover_area(child);
      top += area;
    }
    return largest;
  }

  [[nodiscard]] int largest_front() const {
    int largest = 0;
    for (int s = 0; s < supernodes_.size(); ++s) largest = std::max(largest, height(s));
    return largest;
  }

  void add_matrix(int s, const double* values, double* panel) const {
    const int m = height(s);
    for (int j = supernodes_.first[s]; j < supernodes_.first[s + 1]; ++j) {
      const double* from = values + pattern_->value_begin[j];
      const int own = pattern_->scalar_begin[j] - column_begin_[s];
      double* to = panel + static_cast<std::size_t>(own) * static_cast<std::size_t>(m);
      for (int column = 0; column < pattern_->dimension[j]; ++column) {
        for (std::size_t r = matrix_run_begin_[j]; r < matrix_run_begin_[j + 1]; ++r) {
          const FrontRun& run = matrix_runs_[r];
          for (int i = 0; i < run.length; ++i) to[run.to + i] = from[run.from + i];
        }
        from += pattern_->height[j];
        to += m;
      }
    }
  }

  // Columns first .. last of the parent's front from what `child` left over.
  void add_leftover(int child, const double* source, int first, int last, double* to,
                    int ld) const {
    kernels_.add_lower(leftover_runs_.data() + leftover_run_begin_[child],
                       leftover_runs_.data() + leftover_run_begin_[child + 1], first, last, source,
                       height(child) - width(child), to, ld);
  }

  const FrontKernels& kernels_;
  const BlockPattern* pattern_ = nullptr;
  Supernodes supernodes_;
  std::vector<int> column_begin_, row_begin_, rows_;  ///< in scalars, as in SupernodalFactor
  std::vector<std::size_t> panel_begin_;
  std::vector<FrontRun> matrix_runs_;            ///< from a column of A to a column of its panel
  std::vector<std::size_t> matrix_run_begin_;    ///< by block column
  std::vector<FrontRun> leftover_runs_;          ///< from rows below to rows of the parent's front
  std::vector<std::size_t> leftover_run_begin_;  ///< by supernode
  std::vector<int> last_child_, previous_sibling_;
  std::unique_ptr<double[]> factor_, stack_;
  std::unique_ptr<double[]> inverse_;  ///< reciprocal diagonal of the factor
  std::vector<double> front_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_multifrontal_solver(Kernel kernel) {
  const FrontKernels* kernels = find_front_kernels(kernel);
  CAIRN_CHECK(kernels != nullptr, "a kernel that this processor cannot run");
  return std::make_unique<MultifrontalSolver>(*kernels);
}

}  // namespace cairn
