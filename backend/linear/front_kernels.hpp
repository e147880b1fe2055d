// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace cairn {

/// Dense steps on one front, column-major: m rows, of which the first n are eliminated. One set per
/// instruction set; they differ in rounding only. Arrays must have kFrontSlack readable numbers
/// behind their end.
struct FrontKernels {
  const char* name;  ///< of the instruction set
  /// Turns the panel (m x n, leading dimension m, lower triangle used) into [L11; L21] with
  /// L11 L11^T = A11 and L21 = A21 L11^-T. False where a pivot is not positive.
  bool (*factorize_panel)(int m, int n, double* panel);
  /// C -= L21 L21^T on the lower triangle of C ((m - n) square, leading dimension m - n).
  void (*subtract_square)(int m, int n, const double* panel, double* C);
  /// x[0 .. n) := L11^-1 x[0 .. n), x[n .. m) -= L21 x[0 .. n).
  void (*solve_lower)(int m, int n, const double* panel, double* x);
  /// x[0 .. n) := L11^-T (x[0 .. n) - L21^T x[n .. m)).
  void (*solve_upper)(int m, int n, const double* panel, double* x);
};

constexpr int kFrontSlack = 16;

/// The sets this processor can run, the fastest last.
std::vector<const FrontKernels*> runnable_front_kernels();

}  // namespace cairn
