// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/problem.hpp"

#include "cairn/core/disjoint_sets.hpp"

namespace cairn {
namespace {

// Calls visit(factor, slots of its variables) for each factor of a batch.
template <class Visit>
void for_each_factor(const Graph& graph, const FactorBatch& batch, Visit visit) {
  const std::span<const VariableType> signature = batch.signature();
  const std::span<const std::uint32_t> indices = batch.variable_indices();
  std::array<VariableSlot, 3> slots{};
  for (std::size_t i = 0; i < batch.size(); ++i) {
    for (std::size_t k = 0; k < signature.size(); ++k) {
      slots[k] = graph.slot_of(signature[k], indices[i * signature.size() + k]);
    }
    visit(i, std::span<const VariableSlot>(slots.data(), signature.size()));
  }
}

// What decides whether a component needs a gauge, and which pose would be it.
struct ComponentFacts {
  bool tied_to_map = false;
  int first_pose = -1;
};

}  // namespace

Problem::Problem(const Graph& source) : graph(&source), held(source.variables().size()) {
  const std::span<const Variable> variables = source.variables();
  DisjointSets sets(variables.size());
  std::vector<VariableSlot> tied;  // a slot of each absolute factor
  for (const auto& batch : source.batches()) {
    batches.push_back(batch.get());
    for_each_factor(source, *batch, [&](std::size_t, std::span<const VariableSlot> slots) {
      for (std::size_t k = 1; k < slots.size(); ++k) sets.join(slots[0], slots[k]);
      if (batch->is_absolute()) tied.push_back(slots[0]);
    });
  }
  std::vector<ComponentFacts> facts(variables.size());
  for (const VariableSlot slot : tied) facts[sets.root(slot)].tied_to_map = true;
  for (std::size_t slot = 0; slot < variables.size(); ++slot) {
    const Variable& variable = variables[slot];
    const std::size_t root = sets.root(slot);
    components += root == slot;
    held[slot] = variable.fixed;
    ComponentFacts& component = facts[root];
    component.tied_to_map = component.tied_to_map || variable.fixed;
    const bool first = component.first_pose < 0 || variable.id < variables[component.first_pose].id;
    if (is_pose(variable.type) && first) component.first_pose = static_cast<int>(slot);
  }
  for (const ComponentFacts& component : facts) {
    if (component.tied_to_map || component.first_pose < 0) continue;
    held[component.first_pose] = true;
    gauge.push_back(variables[component.first_pose].id);
  }
}

std::vector<std::pair<int, int>> Problem::coupled_slots() const {
  std::vector<std::pair<int, int>> pairs;
  pairs.reserve(graph->factor_count());
  for (const FactorBatch* batch : batches) {
    for_each_factor(*graph, *batch, [&](std::size_t, std::span<const VariableSlot> slots) {
      for (std::size_t l = 1; l < slots.size(); ++l) {
        for (std::size_t k = 0; k < l; ++k)
          pairs.emplace_back(static_cast<int>(slots[k]), static_cast<int>(slots[l]));
      }
    });
  }
  return pairs;
}

void Problem::drop(const std::vector<bool>& dropped) {
  for (std::size_t slot = 0; slot < dropped.size(); ++slot) {
    if (dropped[slot]) held[slot] = true;
  }
  for (const FactorBatch*& batch : batches) {
    std::vector<std::uint32_t> kept;
    for_each_factor(*graph, *batch, [&](std::size_t i, std::span<const VariableSlot> slots) {
      bool healthy = true;
      for (const VariableSlot slot : slots) healthy = healthy && !dropped[slot];
      if (healthy) kept.push_back(static_cast<std::uint32_t>(i));
    });
    if (kept.size() == batch->size()) continue;
    reduced_.push_back(batch->select(kept));
    batch = reduced_.back().get();
  }
}

}  // namespace cairn
