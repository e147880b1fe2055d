// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <typeindex>
#include <vector>

#include "cairn/core/result.hpp"
#include "cairn/graph/slot_index.hpp"
#include "cairn/graph/typed_batch.hpp"
#include "cairn/graph/variable.hpp"

namespace cairn {

/// Position of a variable in Graph::variables(): dense, in order of insertion.
using VariableSlot = std::uint32_t;

/// Names one factor: batches()[batch], element index.
struct FactorRef {
  std::uint32_t batch;
  std::uint32_t index;
};

/// Variables with their estimates, and batches of factors between them. A value type: copies are
/// deep.
class Graph {
 public:
  Graph() = default;
  Graph(const Graph& other);
  Graph& operator=(const Graph& other);
  Graph(Graph&&) noexcept = default;
  Graph& operator=(Graph&&) noexcept = default;

  /// Adds a variable with its start value. Refused when the id is taken.
  Result<VariableSlot> add_pose2(VariableId id, const Se2& T_map_body);
  Result<VariableSlot> add_pose3(VariableId id, const Se3& T_map_body);
  Result<VariableSlot> add_point2(VariableId id, const Eigen::Vector2d& p_map);
  Result<VariableSlot> add_point3(VariableId id, const Eigen::Vector3d& p_map);

  /// Adds a factor between existing variables, in the order of its signature. Refused when a
  /// variable is unknown, has another type, occurs twice, or when the information is not finite and
  /// positive semidefinite.
  template <class F>
  Result<FactorRef> add_factor(const F& factor,
                               const std::array<VariableId, F::Variables::kArity>& ids,
                               FactorKind kind = FactorKind::kOther);

  [[nodiscard]] std::span<const Variable> variables() const { return variables_; }
  [[nodiscard]] std::optional<VariableSlot> find(VariableId id) const;
  /// Slot of values().<type>[index].
  [[nodiscard]] VariableSlot slot_of(VariableType type, std::uint32_t index) const {
    return slots_[static_cast<std::size_t>(type)][index];
  }
  void set_fixed(VariableSlot slot, bool fixed) { variables_[slot].fixed = fixed; }
  /// Makes room for so many variables in all.
  void reserve(std::size_t variables) {
    variables_.reserve(variables), slot_of_id_.reserve(variables);
  }
  /// Makes room for so many values of one type in all.
  void reserve_values(VariableType type, std::size_t count);
  /// Makes room for so many more factors of one type.
  template <class F>
  void reserve_factors(std::size_t count);

  [[nodiscard]] const Values& values() const { return values_; }
  [[nodiscard]] Values& values() { return values_; }

  [[nodiscard]] std::span<const std::unique_ptr<FactorBatch>> batches() const { return batches_; }
  /// All factors in order of insertion.
  [[nodiscard]] std::span<const FactorRef> factors() const { return factor_order_; }
  [[nodiscard]] std::size_t factor_count() const { return factor_order_.size(); }
  /// The batch of one factor type; null when there is none.
  template <class F>
  [[nodiscard]] const TypedBatch<F>* find_batch() const;
  /// The slots a factor touches, in the order of its signature.
  [[nodiscard]] std::vector<VariableSlot> slots_of(FactorRef factor) const;

  /// The same graph with some of the factors only: those of which `kept`, by place in factors(), is
  /// true. Their order stays.
  [[nodiscard]] Graph with_factors(const std::vector<bool>& kept) const;

  void set_kind(FactorRef factor, FactorKind kind) {
    batches_[factor.batch]->set_kind(factor.index, kind);
  }

 private:
  Result<VariableSlot> add_variable(VariableId id, VariableType type, std::size_t index);
  template <class F>
  std::uint32_t batch_for();

  std::vector<Variable> variables_;
  Values values_;
  std::array<std::vector<VariableSlot>, 4> slots_;
  SlotIndex slot_of_id_;
  std::vector<std::unique_ptr<FactorBatch>> batches_;
  std::vector<std::type_index> batch_types_;
  std::vector<FactorRef> factor_order_;
};

/// Sorts relative factors into odometry and loops (see FactorKind): the first edge between
/// neighbours among one robot's pose ids in sorted order (robot = top byte of the id) is odometry,
/// every other edge between two poses is a loop. Factors already marked kOdometry stay so.
void classify_factor_kinds(Graph& graph);

template <class F>
const TypedBatch<F>* Graph::find_batch() const {
  for (std::size_t b = 0; b < batches_.size(); ++b) {
    if (batch_types_[b] == typeid(F)) return static_cast<const TypedBatch<F>*>(batches_[b].get());
  }
  return nullptr;
}

template <class F>
std::uint32_t Graph::batch_for() {
  for (std::size_t b = 0; b < batches_.size(); ++b) {
    if (batch_types_[b] == typeid(F)) return static_cast<std::uint32_t>(b);
  }
  batches_.push_back(std::make_unique<TypedBatch<F>>());
  batch_types_.emplace_back(typeid(F));
  return static_cast<std::uint32_t>(batches_.size() - 1);
}

template <class F>
void Graph::reserve_factors(std::size_t count) {
  auto& typed = static_cast<TypedBatch<F>&>(*batches_[batch_for<F>()]);
  typed.reserve(typed.size() + count);
  factor_order_.reserve(factor_order_.size() + count);
}

namespace internal {
Error unknown_variable(VariableId id);
Error wrong_variable_type(VariableId id, VariableType expected, VariableType found);
Error repeated_variable(VariableId id);
Error invalid_information(std::string_view factor_name);
}  // namespace internal

template <class F>
Result<FactorRef> Graph::add_factor(const F& factor,
                                    const std::array<VariableId, F::Variables::kArity>& ids,
                                    FactorKind kind) {
  constexpr std::size_t kArity = F::Variables::kArity;
  std::array<std::uint32_t, kArity> indices;
  for (std::size_t k = 0; k < kArity; ++k) {
    const auto slot = slot_of_id_.find(ids[k]);
    if (!slot) return internal::unknown_variable(ids[k]);
    const Variable& variable = variables_[*slot];
    if (variable.type != F::Variables::kArray[k]) {
      return internal::wrong_variable_type(ids[k], F::Variables::kArray[k], variable.type);
    }
    indices[k] = variable.index;
    for (std::size_t l = 0; l < k; ++l) {
      if (ids[l] == ids[k]) return internal::repeated_variable(ids[k]);
    }
  }
  if (!factor.information.allFinite() ||
      !is_positive_semidefinite<F::kDimension>(factor.information)) {
    return internal::invalid_information(F::kName);
  }
  const std::uint32_t batch = batch_for<F>();
  auto& typed = static_cast<TypedBatch<F>&>(*batches_[batch]);
  typed.add(factor, indices, kind);
  const FactorRef ref{batch, static_cast<std::uint32_t>(typed.size() - 1)};
  factor_order_.push_back(ref);
  return ref;
}

}  // namespace cairn
