// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/linear/selected_inverse.hpp"

#include <Eigen/Core>
#include <algorithm>

#include "cairn/core/check.hpp"
#include "cairn/linear/single_thread_blas.hpp"

// BLAS, for panels that are worth the call; Fortran by reference, column-major.
extern "C" {
void dsymm_(const char* side, const char* uplo, const int* m, const int* n, const double* alpha,
            const double* a, const int* lda, const double* b, const int* ldb, const double* beta,
            double* c, const int* ldc);
void dgemm_(const char* transa, const char* transb, const int* m, const int* n, const int* k,
            const double* alpha, const double* a, const int* lda, const double* b, const int* ldb,
            const double* beta, double* c, const int* ldc);
void dtrsm_(const char* side, const char* uplo, const char* transa, const char* diag, const int* m,
            const int* n, const double* alpha, const double* a, const int* lda, double* b,
            const int* ldb);
void dpotri_(const char* uplo, const int* n, double* a, const int* lda, int* info);
}

namespace cairn {
namespace {

using Panel = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
using ConstPanel = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

}  // namespace

SelectedInverse::SelectedInverse(const SupernodalFactor& factor)
    : factor_(factor),
      supernode_of_(static_cast<std::size_t>(factor.super.back())),
      values_(factor.px.back()),
      place_(static_cast<std::size_t>(factor.super.back())) {
  for (int s = 0; s < factor.supernodes(); ++s) {
    std::fill(supernode_of_.begin() + factor.super[s], supernode_of_.begin() + factor.super[s + 1],
              s);
  }
  const SingleThreadBlas single_thread;
  for (int s = factor.supernodes() - 1; s >= 0; --s) invert_supernode(s);
}

// With S the columns of the supernode and R its rows below (Z = A^-1, Takahashi et al. 1973 in
// blocks):
//   W = L_RS L_SS^-1,   Z_RS = -Z_RR W,   Z_SS = (L_SS L_SS^T)^-1 - W^T Z_RS.
// R is a subset of the rows of later supernodes, so Z_RR is known.
void SelectedInverse::invert_supernode(int s) {
  const int columns = factor_.columns(s);
  const int rows = factor_.rows(s);
  const int n = rows - columns;
  const Eigen::OuterStride<> stride(rows);
  const ConstPanel L_SS(factor_.x + factor_.px[s], columns, columns, stride);
  const ConstPanel L_RS(factor_.x + factor_.px[s] + columns, n, columns, stride);
  Panel Z_SS(values_.data() + factor_.px[s], columns, columns, stride);
  Panel Z_RS(values_.data() + factor_.px[s] + columns, n, columns, stride);

  int info = 0;
  Z_SS = L_SS;
  dpotri_("L", &columns, Z_SS.data(), &rows, &info);
  CAIRN_CHECK(info == 0, "the factor has a zero on its diagonal");
  if (n == 0) return;
  gather(factor_.s.subspan(static_cast<std::size_t>(factor_.pi[s] + columns),
                           static_cast<std::size_t>(n)));
  W_.resize(static_cast<std::size_t>(n) * static_cast<std::size_t>(columns));
  Panel W(W_.data(), n, columns, Eigen::OuterStride<>(n));
  W = L_RS;
  const double one = 1.0, zero = 0.0, minus_one = -1.0;
  dtrsm_("R", "L", "N", "N", &n, &columns, &one, L_SS.data(), &rows, W.data(), &n);
  dsymm_("L", "L", &n, &columns, &minus_one, Z_RR_.data(), &n, W.data(), &n, &zero, Z_RS.data(),
         &rows);
  dgemm_("T", "N", &columns, &columns, &n, &minus_one, W.data(), &n, Z_RS.data(), &rows, &one,
         Z_SS.data(), &rows);
}

// The lower triangle of Z at rows and columns `below`, into Z_RR_.
void SelectedInverse::gather(std::span<const int> below) {
  const std::size_t n = below.size();
  Z_RR_.resize(n * n);
  for (std::size_t j = 0; j < n;) {
    const int t = supernode_of_[static_cast<std::size_t>(below[j])];
    const auto rows =
        factor_.s.subspan(static_cast<std::size_t>(factor_.pi[t]),
                          static_cast<std::size_t>(factor_.pi[t + 1] - factor_.pi[t]));
    // Rows from below[j] on are all rows of t: walk both ascending lists once.
    std::size_t at = 0;
    for (std::size_t i = j; i < n; ++i) {
      while (rows[at] != below[i]) ++at;
      place_[i] = static_cast<int>(at);
    }
    const double* panel = values_.data() + factor_.px[t];
    const int end = factor_.super[t + 1];
    for (; j < n && below[j] < end; ++j) {
      const double* column =
          panel + static_cast<std::size_t>(below[j] - factor_.super[t]) * rows.size();
      double* out = Z_RR_.data() + j * n;
      for (std::size_t i = j; i < n; ++i) out[i] = column[place_[i]];
    }
  }
}

const double* SelectedInverse::find(int row, int column) const {
  if (row < column) std::swap(row, column);
  const int s = supernode_of_[static_cast<std::size_t>(column)];
  const auto begin = factor_.s.begin() + factor_.pi[s];
  const auto end = factor_.s.begin() + factor_.pi[s + 1];
  const auto at = std::lower_bound(begin, end, row);
  if (at == end || *at != row) return nullptr;
  return &values_[factor_.px[s] +
                  static_cast<std::size_t>(column - factor_.super[s]) *
                      static_cast<std::size_t>(end - begin) +
                  static_cast<std::size_t>(at - begin)];
}

}  // namespace cairn
