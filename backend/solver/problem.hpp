// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "cairn/graph/graph.hpp"

namespace cairn {

/// The part of a graph that is solved: which variables are held where they are and which factors
/// count.
struct Problem {
  explicit Problem(const Graph& source);

  /// Pairs of variables that share a factor in use, as slots; a factor of three variables gives
  /// three pairs.
  [[nodiscard]] std::vector<std::pair<int, int>> coupled_slots() const;
  /// Holds the variables marked in `dropped` (by slot) and takes every factor that touches one out
  /// of use.
  void drop(const std::vector<bool>& dropped);

  /// A variable kept from moving in some directions of its tangent space, because no measurement
  /// does.
  struct Anchor {
    int slot;
    Eigen::MatrixXd directions;  ///< orthonormal columns
  };

  const Graph* graph;
  std::vector<bool> held;                   ///< by slot
  std::vector<const FactorBatch*> batches;  ///< factors in use
  std::vector<VariableId>
      gauge;  ///< poses held because nothing else ties their component to the map
  std::vector<Anchor> anchors;
  int components = 0;

 private:
  std::vector<std::unique_ptr<FactorBatch>> reduced_;  // owners of batches that lost factors
};

}  // namespace cairn
