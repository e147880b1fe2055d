// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>

#include "cairn/io/graph_tags.hpp"

namespace cairn {

/// One edge line, parsed: what a factor is made of.
struct EdgeFields {
  const TagSpec* tag = nullptr;
  std::array<VariableId, 2> ids{};
  std::array<ParameterId, 2> parameters{};
  std::array<const Se2*, 2> offsets2{};  ///< values of `parameters` where the poses are planar,
  std::array<const Se3*, 2> offsets3{};  ///< and where they are not
  std::span<const double> measurement;
  std::span<const double> information;  ///< empty: the identity
};

/// How the lines of one edge tag become factors.
struct EdgeDecoder {
  /// Refused as Graph::add_factor refuses; errors have no place.
  Result<FactorRef> (*add)(Graph& graph, const EdgeFields& fields, FactorKind kind);
  /// Makes room for `count` factors to come.
  void (*reserve)(Graph& graph, std::size_t count);
};

/// The decoder of an edge tag of any format.
const EdgeDecoder& edge_decoder(const TagSpec& tag);

Se2 se2_from_columns(std::span<const double> columns);                 ///< x y theta
Se3 se3_from_quaternion_columns(std::span<const double> columns);      ///< x y z qx qy qz qw
Se3 se3_from_roll_pitch_yaw_columns(std::span<const double> columns);  ///< x y z roll pitch yaw

}  // namespace cairn
