// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "cairn/core/result.hpp"
#include "cairn/geometry/geodesy.hpp"
#include "cairn/graph/graph.hpp"
#include "cairn/graph/transaction.hpp"

namespace cairn {

/// What the journal and the wire know of a factor type. Numbers and names never change their
/// meaning; new types get new numbers.
struct FactorTypeInfo {
  FactorType type;
  std::string_view name;  ///< the factor's kName
  std::vector<VariableType> signature;
  std::size_t numbers;    ///< how many NewFactor::numbers holds: see backend/factors/README.md
  bool at_datum = false;  ///< its map positions are in the frame at a datum that it names
};

/// All known types, ascending.
std::span<const FactorTypeInfo> factor_types();
/// Null where the number is of no known type.
const FactorTypeInfo* find_factor_type(FactorType type);

/// Loop closures between two poses: those about which the gate decides.
bool is_gated(FactorType type, FactorKind kind);

/// A factor of a graph as numbers (m, rad), without its nodes.
NewFactor describe_factor(const Graph& graph, FactorRef factor);

/// Refuses a wrong count of nodes or numbers, numbers that are not finite, quaternions that are not
/// of unit length (1e-3), and information that is not positive semidefinite. The message says what
/// was found.
struct FactorFault {
  RefusalCode code;
  std::string reason;
};
std::optional<FactorFault> find_fault(const NewFactor& factor);

/// The datum that a factor without fault names: its map is the east-north-up frame there.
std::optional<Geodetic> datum_of(const NewFactor& factor);
/// Makes a GNSS factor one at this datum. False, and no change, for other factors.
bool set_datum(NewFactor& factor, const Geodetic& datum);

/// Adds a factor without fault between existing variables.
Result<FactorRef> add_factor(Graph& graph, const NewFactor& factor,
                             std::span<const VariableId> ids);

/// A start value or odometry pose as numbers, and back: x y theta; x y z qx qy qz qw; x y; x y z.
std::vector<double> describe_value(const Graph& graph, VariableSlot slot);
constexpr std::size_t value_numbers(VariableType type) {
  constexpr std::size_t kCounts[] = {3, 7, 2, 3};
  return kCounts[static_cast<std::size_t>(type)];
}
/// Refuses a wrong count, numbers that are not finite, and quaternions not of unit length.
std::optional<FactorFault> find_fault(VariableType type, std::span<const double> value);
/// Adds a variable whose start value has no fault.
Result<VariableSlot> add_variable(Graph& graph, VariableId id, VariableType type,
                                  std::span<const double> start);

}  // namespace cairn
