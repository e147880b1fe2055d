// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "cairn/graph/graph.hpp"

namespace cairn {

/// A free variable that its own measurements cannot determine even if every other variable were
/// known: the diagonal block of the normal equations is singular. (That the blocks are regular does
/// not yet mean the whole graph is.)
struct UndeterminedVariable {
  VariableSlot slot;
  std::size_t factors = 0;  ///< how many measure it; 0: none at all
  Eigen::MatrixXd
      free_directions;  ///< orthonormal columns in its tangent space (translation m, rotation rad)
};

/// All of them at the current values, in slot order. Variables with non-finite blocks are left out.
std::vector<UndeterminedVariable> find_undetermined_variables(const Graph& graph);

}  // namespace cairn
