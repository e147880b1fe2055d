// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "cairn/linear/kernel.hpp"

namespace cairn {

/// `length` neighboring rows of one front that are rows of another.
struct FrontRun {
  int from, to, length;
};

/// Dense steps on one front, column-major: m rows, of which the first n are eliminated. One set per
/// instruction set; they differ in rounding only. Arrays must have kFrontSlack readable numbers
/// behind their end.
struct FrontKernels {
  Kernel kernel;  ///< its name
  /// Turns the panel (m x n, leading dimension m, lower triangle used) into [L11; L21] with
  /// L11 L11^T = A11 and L21 = A21 L11^-T, and the reciprocals of the diagonal of L11 into
  /// `inverse` (n). False where a pivot is not positive.
  bool (*factorize_panel)(int m, int n, double* panel, double* inverse);
  /// The lower triangle of C := -L21 L21^T ((m - n) square, leading dimension m - n).
  void (*negative_square)(int m, int n, const double* panel, double* C);
  /// Adds the lower triangle of `from` to `to`, whose first row and column are `first` of the front
  /// the runs lead to; only columns first .. last of it.
  void (*add_lower)(const FrontRun* begin, const FrontRun* end, int first, int last,
                    const double* from, long ld_from, double* to, long ld_to);
  /// x[0 .. n) := L11^-1 x[0 .. n), x[n .. m) -= L21 x[0 .. n).
  void (*solve_lower)(int m, int n, const double* panel, const double* inverse, double* x);
  /// x[0 .. n) := L11^-T (x[0 .. n) - L21^T x[n .. m)).
  void (*solve_upper)(int m, int n, const double* panel, const double* inverse, double* x);
};

constexpr int kFrontSlack = 16;

/// The sets this processor can run, the fastest last.
std::vector<const FrontKernels*> runnable_front_kernels();
/// Null where this processor cannot run it.
const FrontKernels* find_front_kernels(Kernel kernel);

}  // namespace cairn
