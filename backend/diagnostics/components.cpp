// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/components.hpp"

#include <algorithm>

#include "cairn/core/disjoint_sets.hpp"

namespace cairn {
std::vector<Component> connected_components(const Graph& graph) {
  const auto variables = graph.variables();
  DisjointSets sets(variables.size());
  const auto slot_of = [&](const FactorBatch& batch, std::size_t i, std::size_t k) {
    return graph.slot_of(batch.signature()[k],
                         batch.variable_indices()[i * batch.signature().size() + k]);
  };
  for (const auto& batch : graph.batches()) {
    for (std::size_t i = 0; i < batch->size(); ++i) {
      for (std::size_t k = 1; k < batch->signature().size(); ++k)
        sets.join(slot_of(*batch, i, 0), slot_of(*batch, i, k));
    }
  }
  std::vector<Component> components;
  std::vector<std::size_t> component_of_root(variables.size());
  for (VariableSlot slot = 0; slot < variables.size(); ++slot) {
    const Variable& variable = variables[slot];
    const std::size_t root = sets.root(slot);  // the smallest slot of its set, so it comes first
    if (root == slot) {
      component_of_root[root] = components.size();
      components.push_back({.smallest = variable.id});
    }
    Component& component = components[component_of_root[root]];
    ++component.variables;
    component.smallest = std::min(component.smallest, variable.id);
    if (is_pose(variable.type)) {
      component.smallest_pose =
          std::min(component.smallest_pose.value_or(variable.id), variable.id);
    }
    if (variable.fixed) component.fixed.push_back(variable.id);
  }
  for (const auto& batch : graph.batches()) {
    for (std::size_t i = 0; i < batch->size(); ++i) {
      Component& component = components[component_of_root[sets.root(slot_of(*batch, i, 0))]];
      ++component.factors;
      component.absolute |= batch->is_absolute();
    }
  }
  std::sort(components.begin(), components.end(),
            [](const Component& a, const Component& b) { return a.smallest < b.smallest; });
  return components;
}

}  // namespace cairn
