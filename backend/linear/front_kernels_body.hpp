// SPDX-License-Identifier: BSD-3-Clause
// The body of one set of front kernels: included once by each front_kernels_*.cpp, which is
// compiled for its instruction set and defines CAIRN_FRONT_KERNELS, the name of the set. Nothing
// from other headers may be instantiated here: the linker could hand that code to processors that
// cannot run it.
#include "cairn/linear/front_kernels.hpp"

#ifdef __AVX512F__
#include <immintrin.h>
#endif

namespace cairn {
namespace {

#ifdef __AVX512F__
constexpr int kWidth = 8;
constexpr Kernel kName = Kernel::kAvx512;
#elif defined(__AVX__)
constexpr int kWidth = 4;
constexpr Kernel kName = Kernel::kAvx2;
#else
constexpr int kWidth = 2;
constexpr Kernel kName = Kernel::kPortable;
#endif
// Columns that are computed together: accumulators for two vectors of rows stay in registers.
constexpr int kColumns = 6;

typedef double Vector __attribute__((vector_size(kWidth * sizeof(double))));
typedef double UnalignedVector
    __attribute__((vector_size(kWidth * sizeof(double)), aligned(sizeof(double)), may_alias));

inline Vector load(const double* p) { return *reinterpret_cast<const UnalignedVector*>(p); }

// The first `count` (at most kWidth) numbers, zeros behind them.
inline Vector load(const double* p, int count) {
#ifdef __AVX512F__
  return _mm512_maskz_loadu_pd(static_cast<__mmask8>(0xffu >> (kWidth - count)), p);
#else
  if (count == kWidth) return load(p);
  Vector v{};
  for (int i = 0; i < kWidth - 1; ++i) {
    if (i < count) v[i] = p[i];
  }
  return v;
#endif
}

inline void store(double* p, Vector v, int count) {
#ifdef __AVX512F__
  _mm512_mask_storeu_pd(p, static_cast<__mmask8>(0xffu >> (kWidth - count)), v);
#else
  if (count == kWidth) {
    *reinterpret_cast<UnalignedVector*>(p) = v;
  } else {
    for (int i = 0; i < kWidth - 1; ++i) {
      if (i < count) p[i] = v[i];
    }
  }
#endif
}

// sum_p A(:, p) B(j, p) for kVectors vectors of rows of A and `columns` rows of B.
template <int kVectors, int columns>
inline void multiply(int depth, const double* A, const double* B, long ld,
                     Vector (&sum)[kVectors][columns]) {
  for (int v = 0; v < kVectors; ++v)
    for (int j = 0; j < columns; ++j) sum[v][j] = Vector{};
  for (int p = 0; p < depth; ++p, A += ld, B += ld) {
    Vector a[kVectors];
    for (int v = 0; v < kVectors; ++v) a[v] = load(A + v * kWidth);
    for (int j = 0; j < columns; ++j) {
      for (int v = 0; v < kVectors; ++v) sum[v][j] += a[v] * B[j];
    }
  }
}

// C(rows, columns) := base - A B^T, where `rows` of A (at most kVectors vectors) count; base is C
// or nothing.
template <int kVectors, int columns, bool base>
inline void subtract_tile(int rows, int depth, const double* A, const double* B, long ld, double* C,
                          long ldc) {
  Vector sum[kVectors][columns];
  multiply<kVectors, columns>(depth, A, B, ld, sum);
  for (int j = 0; j < columns; ++j) {
    for (int v = 0; v < kVectors; ++v) {
      double* c = C + j * ldc + v * kWidth;
      const int count = rows - v * kWidth;
      if (count <= 0) continue;
      store(c, base ? load(c) - sum[v][j] : -sum[v][j], count < kWidth ? count : kWidth);
    }
  }
}

template <int columns, bool base>
inline void subtract_columns(int rows, int depth, const double* A, const double* B, long ld,
                             double* C, long ldc) {
  int i = 0;
  for (; rows - i > kWidth; i += 2 * kWidth)
    subtract_tile<2, columns, base>(rows - i, depth, A + i, B, ld, C + i, ldc);
  if (i < rows) subtract_tile<1, columns, base>(rows - i, depth, A + i, B, ld, C + i, ldc);
}

// A square of `columns` by Cholesky, its reciprocal pivots into `inverse`.
template <int columns>
inline bool factorize_square(double* A, long ld, double* inverse) {
  for (int j = 0; j < columns; ++j) {
    double pivot = A[j * ld + j];
    for (int p = 0; p < j; ++p) pivot -= A[p * ld + j] * A[p * ld + j];
    if (!(pivot > 0.0) || !(pivot < 1e300)) return false;
    const double root = __builtin_sqrt(pivot);
    A[j * ld + j] = root;
    inverse[j] = 1.0 / root;
    for (int i = j + 1; i < columns; ++i) {
      double a = A[j * ld + i];
      for (int p = 0; p < j; ++p) a -= A[p * ld + i] * A[p * ld + j];
      A[j * ld + i] = a * inverse[j];
    }
  }
  return true;
}

// X := (X - A B^T) L^-T for the rows below a square L.
template <int kVectors, int columns>
inline void solve_tile(int rows, int depth, const double* A, const double* B, long ld,
                       const double* L, const double* inverse, double* X) {
  Vector x[kVectors][columns];
  multiply<kVectors, columns>(depth, A, B, ld, x);
  for (int v = 0; v < kVectors; ++v) {
    const int count = rows - v * kWidth < kWidth ? rows - v * kWidth : kWidth;
    for (int j = 0; j < columns; ++j) {
      Vector value = load(X + j * ld + v * kWidth) - x[v][j];
      for (int p = 0; p < j; ++p) value -= x[v][p] * L[p * ld + j];
      x[v][j] = value * inverse[j];
    }
    if (count <= 0) continue;
    for (int j = 0; j < columns; ++j) store(X + j * ld + v * kWidth, x[v][j], count);
  }
}

// Columns k .. k + columns of the panel, once those before are done.
template <int columns>
inline bool factorize_columns(int m, int k, double* panel, double* inverse) {
  const long ld = m;
  inverse += k;
  double* square = panel + k * ld + k;
  subtract_columns<columns, true>(columns, k, panel + k, panel + k, ld, square, ld);
  if (!factorize_square<columns>(square, ld, inverse)) return false;
  int i = k + columns;
  for (; m - i > kWidth; i += 2 * kWidth)
    solve_tile<2, columns>(m - i, k, panel + i, panel + k, ld, square, inverse, panel + k * ld + i);
  if (i < m)
    solve_tile<1, columns>(m - i, k, panel + i, panel + k, ld, square, inverse, panel + k * ld + i);
  return true;
}

bool factorize_panel(int m, int n, double* panel, double* inverse) {
  int k = 0;
  for (; n - k >= kColumns; k += kColumns) {
    if (!factorize_columns<kColumns>(m, k, panel, inverse)) return false;
  }
  switch (n - k) {
    case 1:
      return factorize_columns<1>(m, k, panel, inverse);
    case 2:
      return factorize_columns<2>(m, k, panel, inverse);
    case 3:
      return factorize_columns<3>(m, k, panel, inverse);
    case 4:
      return factorize_columns<4>(m, k, panel, inverse);
    case 5:
      return factorize_columns<5>(m, k, panel, inverse);
    default:
      return true;
  }
}

void negative_square(int m, int n, const double* panel, double* C) {
  const long ld = m;
  const int size = m - n;
  const double* below = panel + n;
  int j = 0;
  for (; size - j >= kColumns; j += kColumns)
    subtract_columns<kColumns, false>(size - j, n, below + j, below + j, ld, C + j * long{size} + j,
                                      size);
  const double* rest = below + j;
  double* corner = C + j * long{size} + j;
  switch (size - j) {
    case 1:
      return subtract_columns<1, false>(1, n, rest, rest, ld, corner, size);
    case 2:
      return subtract_columns<2, false>(2, n, rest, rest, ld, corner, size);
    case 3:
      return subtract_columns<3, false>(3, n, rest, rest, ld, corner, size);
    case 4:
      return subtract_columns<4, false>(4, n, rest, rest, ld, corner, size);
    case 5:
      return subtract_columns<5, false>(5, n, rest, rest, ld, corner, size);
    default:
      return;
  }
}

void add_run(const FrontRun& run, int skipped, const double* from, double* to, long shift) {
  from += run.from;
  to += run.to - shift;
  for (int i = skipped; i < run.length; i += kWidth) {
    const int left = run.length - i, count = left < kWidth ? left : kWidth;
    store(to + i, load(to + i) + load(from + i), count);
  }
}

void add_lower(const FrontRun* begin, const FrontRun* end, int first, int last, const double* from,
               long ld_from, double* to, long ld_to) {
  for (const FrontRun* columns = begin; columns != end; ++columns) {
    const int c_first = columns->to < first ? first - columns->to : 0;
    const int c_last = columns->to + columns->length > last ? last - columns->to : columns->length;
    for (int c = c_first; c < c_last; ++c) {
      const double* from_column = from + (columns->from + c) * ld_from;
      double* to_column = to + (columns->to + c - first) * ld_to;
      add_run(*columns, c, from_column, to_column, first);
      for (const FrontRun* rows = columns + 1; rows != end; ++rows)
        add_run(*rows, 0, from_column, to_column, first);
    }
  }
}

// Four columns at a time read and write x a quarter as often.
constexpr int kSolved = 4;

template <int columns>
inline void solve_lower_columns(int m, int j, const double* panel, const double* inverse,
                                double* x) {
  const double* L[columns];
  for (int c = 0; c < columns; ++c) L[c] = panel + (j + c) * long{m};
  for (int c = 0; c < columns; ++c) {
    double value = x[j + c];
    for (int p = 0; p < c; ++p) value -= L[p][j + c] * x[j + p];
    x[j + c] = value * inverse[j + c];
  }
  for (int i = j + columns; i < m; i += kWidth) {
    Vector sum = load(x + i);
    for (int c = 0; c < columns; ++c) sum -= load(L[c] + i) * x[j + c];
    store(x + i, sum, m - i < kWidth ? m - i : kWidth);
  }
}

template <int columns>
inline void solve_upper_columns(int m, int j, const double* panel, const double* inverse,
                                double* x) {
  const double* L[columns];
  Vector sum[columns];
  for (int c = 0; c < columns; ++c) {
    L[c] = panel + (j + c) * long{m};
    sum[c] = Vector{};
  }
  for (int i = j + columns; i < m; i += kWidth) {
    const Vector below = load(x + i, m - i < kWidth ? m - i : kWidth);
    // What is behind the column's end may be anything, also not a number.
    for (int c = 0; c < columns; ++c)
      sum[c] += load(L[c] + i, m - i < kWidth ? m - i : kWidth) * below;
  }
  for (int c = columns - 1; c >= 0; --c) {
    double value = x[j + c];
    for (int lane = 0; lane < kWidth; ++lane) value -= sum[c][lane];
    for (int p = c + 1; p < columns; ++p) value -= L[c][j + p] * x[j + p];
    x[j + c] = value * inverse[j + c];
  }
}

void solve_lower(int m, int n, const double* panel, const double* inverse, double* x) {
  int j = 0;
  for (; n - j >= kSolved; j += kSolved) solve_lower_columns<kSolved>(m, j, panel, inverse, x);
  for (; j < n; ++j) solve_lower_columns<1>(m, j, panel, inverse, x);
}

void solve_upper(int m, int n, const double* panel, const double* inverse, double* x) {
  int j = n;
  for (; j % kSolved != 0; --j) solve_upper_columns<1>(m, j - 1, panel, inverse, x);
  for (; j > 0; j -= kSolved) solve_upper_columns<kSolved>(m, j - kSolved, panel, inverse, x);
}

}  // namespace

extern const FrontKernels CAIRN_FRONT_KERNELS{kName,     factorize_panel, negative_square,
                                              add_lower, solve_lower,     solve_upper};

}  // namespace cairn
