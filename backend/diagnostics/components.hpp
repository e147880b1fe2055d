// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "cairn/graph/graph.hpp"

namespace cairn {

/// A part of the graph that no measurement ties to the rest.
struct Component {
  VariableId smallest;                        ///< its name
  std::optional<VariableId> smallest_pose{};  ///< where the solver holds it if nothing else does
  std::size_t variables = 0;
  std::size_t factors = 0;
  std::vector<VariableId> fixed{};  ///< variables of it that are held fixed
  bool absolute = false;            ///< has a factor that ties it to the map frame

  [[nodiscard]] bool needs_gauge() const { return fixed.empty() && !absolute && factors > 0; }
};

/// The connected components, by ascending smallest id. A variable without factors is a component of
/// its own.
std::vector<Component> connected_components(const Graph& graph);

}  // namespace cairn
