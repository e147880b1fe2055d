// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/linear/selected_inverse.hpp"

#include <Eigen/Core>
#include <algorithm>

namespace cairn {
namespace {

using Panel = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
using ConstPanel = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

}  // namespace

SelectedInverse::SelectedInverse(const SupernodalFactor& factor)
    : factor_(factor),
      supernode_of_(static_cast<std::size_t>(factor.super.back())),
      values_(static_cast<std::size_t>(factor.px.back())),
      place_(static_cast<std::size_t>(factor.super.back())) {
  for (int s = 0; s < factor.supernodes(); ++s) {
    std::fill(supernode_of_.begin() + factor.super[s], supernode_of_.begin() + factor.super[s + 1],
              s);
  }
  for (int s = factor.supernodes() - 1; s >= 0; --s) invert_supernode(s);
}

// With S the columns of the supernode and R its rows below (Z = A^-1, Takahashi et al. 1973 in
// blocks):
//   W = L_RS L_SS^-1,   Z_RS = -Z_RR W,   Z_SS = L_SS^-T L_SS^-1 - W^T Z_RS.
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

  const Eigen::MatrixXd L_SS_inverse =
      L_SS.triangularView<Eigen::Lower>().solve(Eigen::MatrixXd::Identity(columns, columns));
  Z_SS.noalias() = L_SS_inverse.transpose() * L_SS_inverse;
  if (n == 0) return;
  gather(factor_.s.subspan(static_cast<std::size_t>(factor_.pi[s] + columns),
                           static_cast<std::size_t>(n)));
  const Panel Z_RR(Z_RR_.data(), n, n, Eigen::OuterStride<>(n));
  W_.resize(static_cast<std::size_t>(n * columns));
  Panel W(W_.data(), n, columns, Eigen::OuterStride<>(n));
  W.noalias() = L_RS * L_SS_inverse.triangularView<Eigen::Lower>();
  Z_RS.noalias() = -(Z_RR.selfadjointView<Eigen::Lower>() * W);
  Z_SS.noalias() -= W.transpose() * Z_RS;
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
  return &values_[static_cast<std::size_t>(factor_.px[s]) +
                  static_cast<std::size_t>(column - factor_.super[s]) *
                      static_cast<std::size_t>(end - begin) +
                  static_cast<std::size_t>(at - begin)];
}

}  // namespace cairn
