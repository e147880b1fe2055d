// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/graph/graph.hpp"

#include <algorithm>

namespace cairn {

Graph::Graph(const Graph& other)
    : variables_(other.variables_),
      values_(other.values_),
      slots_(other.slots_),
      slot_of_id_(other.slot_of_id_),
      batch_types_(other.batch_types_),
      factor_order_(other.factor_order_) {
  batches_.reserve(other.batches_.size());
  for (const auto& batch : other.batches_) batches_.push_back(batch->clone());
}

Graph& Graph::operator=(const Graph& other) {
  if (this != &other) *this = Graph(other);
  return *this;
}

Graph Graph::with_factors(const std::vector<bool>& kept) const {
  Graph graph;
  graph.variables_ = variables_;
  graph.values_ = values_;
  graph.slots_ = slots_;
  graph.slot_of_id_ = slot_of_id_;
  graph.batch_types_ = batch_types_;
  std::vector<std::vector<std::uint32_t>> chosen(batches_.size());
  for (std::size_t place = 0; place < factor_order_.size(); ++place) {
    if (!kept[place]) continue;
    const FactorRef factor = factor_order_[place];
    std::vector<std::uint32_t>& own = chosen[factor.batch];
    graph.factor_order_.push_back({factor.batch, static_cast<std::uint32_t>(own.size())});
    own.push_back(factor.index);
  }
  for (std::size_t b = 0; b < batches_.size(); ++b)
    graph.batches_.push_back(batches_[b]->select(chosen[b]));
  return graph;
}

Result<VariableSlot> Graph::add_variable(VariableId id, VariableType type, std::size_t index) {
  const auto slot = static_cast<VariableSlot>(variables_.size());
  if (!slot_of_id_.insert(id, slot)) {
    return Error{ErrorCode::kBadInput,
                 "variable " + std::to_string(id.value) + " is defined twice"};
  }
  variables_.push_back({id, type, static_cast<std::uint32_t>(index), false});
  slots_[static_cast<std::size_t>(type)].push_back(slot);
  return slot;
}

Result<VariableSlot> Graph::add_pose2(VariableId id, const Se2& T_map_body) {
  auto slot = add_variable(id, VariableType::kPose2, values_.pose2.size());
  if (slot) values_.pose2.push_back(T_map_body);
  return slot;
}

Result<VariableSlot> Graph::add_pose3(VariableId id, const Se3& T_map_body) {
  auto slot = add_variable(id, VariableType::kPose3, values_.pose3.size());
  if (slot) values_.pose3.push_back(T_map_body);
  return slot;
}

Result<VariableSlot> Graph::add_point2(VariableId id, const Eigen::Vector2d& p_map) {
  auto slot = add_variable(id, VariableType::kPoint2, values_.point2.size());
  if (slot) values_.point2.push_back(p_map);
  return slot;
}

Result<VariableSlot> Graph::add_point3(VariableId id, const Eigen::Vector3d& p_map) {
  auto slot = add_variable(id, VariableType::kPoint3, values_.point3.size());
  if (slot) values_.point3.push_back(p_map);
  return slot;
}

void Graph::reserve_values(VariableType type, std::size_t count) {
  slots_[static_cast<std::size_t>(type)].reserve(count);
  switch (type) {
    case VariableType::kPose2:
      return values_.pose2.reserve(count);
    case VariableType::kPose3:
      return values_.pose3.reserve(count);
    case VariableType::kPoint2:
      return values_.point2.reserve(count);
    case VariableType::kPoint3:
      return values_.point3.reserve(count);
  }
}

std::optional<VariableSlot> Graph::find(VariableId id) const { return slot_of_id_.find(id); }

std::vector<VariableSlot> Graph::slots_of(FactorRef factor) const {
  const FactorBatch& batch = *batches_[factor.batch];
  const std::span<const VariableType> signature = batch.signature();
  std::vector<VariableSlot> slots;
  slots.reserve(signature.size());
  for (std::size_t k = 0; k < signature.size(); ++k) {
    slots.push_back(
        slot_of(signature[k], batch.variable_indices()[factor.index * signature.size() + k]));
  }
  return slots;
}

namespace {

bool is_relative_pose_batch(const FactorBatch& batch) {
  const auto signature = batch.signature();
  return signature.size() == 2 && is_pose(signature[0]) && is_pose(signature[1]);
}

// For each pose slot, the slot of the next pose id of the same robot (or itself at the end of a
// trajectory).
std::vector<VariableSlot> successors(const Graph& graph) {
  const auto variables = graph.variables();
  std::vector<VariableSlot> poses, next(variables.size());
  for (VariableSlot s = 0; s < variables.size(); ++s) {
    next[s] = s;
    if (is_pose(variables[s].type)) poses.push_back(s);
  }
  const auto by_id = [&](VariableSlot a, VariableSlot b) {
    return variables[a].id < variables[b].id;
  };
  if (!std::is_sorted(poses.begin(), poses.end(), by_id))
    std::sort(poses.begin(), poses.end(), by_id);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const bool same_robot =
        variables[poses[i - 1]].id.value >> 56 == variables[poses[i]].id.value >> 56;
    if (same_robot) next[poses[i - 1]] = poses[i];
  }
  return next;
}

}  // namespace

void classify_factor_kinds(Graph& graph) {
  const std::vector<VariableSlot> next = successors(graph);
  std::vector<bool> has_odometry(next.size(), false);  // for the pair (slot, next[slot])
  std::vector<bool> is_relative;                       // by batch
  for (const auto& batch : graph.batches()) is_relative.push_back(is_relative_pose_batch(*batch));
  // Calls visit(factor, slot) for each relative factor, with the slot of the earlier pose where it
  // joins neighbors.
  const auto for_each_relative = [&](const auto& visit) {
    for (const FactorRef factor : graph.factors()) {
      if (!is_relative[factor.batch]) continue;
      const FactorBatch& batch = *graph.batches()[factor.batch];
      const std::uint32_t* indices = &batch.variable_indices()[2 * std::size_t{factor.index}];
      const VariableSlot a = graph.slot_of(batch.signature()[0], indices[0]);
      const VariableSlot b = graph.slot_of(batch.signature()[1], indices[1]);
      std::optional<VariableSlot> start;
      if (next[a] == b) start = a;
      if (next[b] == a) start = b;
      visit(factor, batch.kinds()[factor.index], start);
    }
  };
  using Start = std::optional<VariableSlot>;
  for_each_relative([&](FactorRef, FactorKind kind, Start start) {
    if (kind == FactorKind::kOdometry && start) has_odometry[*start] = true;
  });
  for_each_relative([&](FactorRef factor, FactorKind kind, Start start) {
    if (kind == FactorKind::kOdometry) return;
    const bool odometry = start && !has_odometry[*start];
    if (odometry) has_odometry[*start] = true;
    graph.set_kind(factor, odometry ? FactorKind::kOdometry : FactorKind::kLoop);
  });
}

namespace internal {

Error unknown_variable(VariableId id) {
  return {ErrorCode::kBadInput,
          "factor refers to variable " + std::to_string(id.value) + ", which is not defined"};
}

Error wrong_variable_type(VariableId id, VariableType expected, VariableType found) {
  return {ErrorCode::kBadInput, "variable " + std::to_string(id.value) + " is a " +
                                    std::string(to_string(found)) + ", but the factor needs a " +
                                    std::string(to_string(expected))};
}

Error repeated_variable(VariableId id) {
  return {ErrorCode::kBadInput,
          "factor connects variable " + std::to_string(id.value) + " with itself"};
}

Error invalid_information(std::string_view factor_name) {
  return {ErrorCode::kBadInput,
          std::string(factor_name) + " information is not finite and positive semidefinite"};
}

}  // namespace internal
}  // namespace cairn
