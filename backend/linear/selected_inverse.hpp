// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "cairn/linear/linear_solver.hpp"

namespace cairn {

/// The entries of A^-1 (in the factor's order) at the non-zeros of L: Takahashi's recursion, one
/// dense step per supernode from the last to the first. Costs two to three times the factorization.
class SelectedInverse {
 public:
  /// The factor's index arrays must outlive this object; its values are read only here.
  explicit SelectedInverse(const SupernodalFactor& factor);

  /// Entry (row, column) of P A^-1 P^T; null outside the pattern of L + L^T.
  [[nodiscard]] const double* find(int row, int column) const;

 private:
  void invert_supernode(int s);
  void gather(std::span<const int> below);

  SupernodalFactor factor_;
  std::vector<int> supernode_of_;  ///< per column
  std::vector<double> values_;     ///< laid out as the factor's
  // Workspace of invert_supernode.
  std::vector<double> Z_RR_, W_;
  std::vector<int> place_;  ///< row -> position among the rows of one supernode
};

}  // namespace cairn
