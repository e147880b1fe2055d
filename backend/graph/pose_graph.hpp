// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cairn/geometry/geodesy.hpp"
#include "cairn/graph/chunked_vector.hpp"
#include "cairn/graph/transaction.hpp"

namespace cairn {

/// Place of a node in PoseGraph::nodes: order of arrival.
using NodeIndex = std::uint32_t;

struct StoredNode {
  NodeId id;
  std::uint64_t record;  ///< that brought it
  VariableType type;
  std::int64_t stamp_ns;
  std::vector<double> start;
  std::vector<double> odometry;
  /// Its scans and images, as factors name them (README.md); ascending, each once.
  std::vector<ContentHash> payloads{};
};

/// Whether a factor takes part in the estimate: committed and trusted ones do. A loop closure is
/// pending until the gate has decided, and quarantined where it contradicts the rest; about trusted
/// ones an operator has decided. Numbers are those of the journal.
enum class FactorState : std::uint8_t {
  kPending = 0,
  kCommitted = 1,
  kQuarantined = 2,
  kDisabled = 3,
  kRemoved = 4,
  kTrusted = 5,
};

/// Nobody has switched it off.
constexpr bool is_enabled(FactorState state) {
  return state != FactorState::kDisabled && state != FactorState::kRemoved;
}
constexpr bool takes_part(FactorState state) {
  return state == FactorState::kCommitted || state == FactorState::kTrusted;
}

struct StoredFactor {
  FactorName name;
  std::uint64_t record;  ///< that brought it
  FactorType type;
  FactorKind kind;
  FactorState state = FactorState::kCommitted;
  std::vector<NodeIndex> nodes;
  std::vector<double> numbers;
};

/// The numbers of an estimate, as in NewVariable::start; the rest is zero.
using Estimate = std::array<double, 7>;

/// How many loop closures tie two robots, or two odometry epochs, into one map, by default.
inline constexpr std::size_t kLoopsThatMerge = 3;

/// Everything a daemon knows of its map at one revision. A value whose copies share memory: taking
/// one costs microseconds, whatever the size (a snapshot), and keeps its content while the original
/// goes on.
struct PoseGraph {
  Revision graph_revision;   ///< last record that is in here
  Revision solved_revision;  ///< what the estimates of the last solve were computed from
  std::size_t first_unsolved_factor =
      0;                              ///< place in `factors`: those from here on came since then
  bool switched_since_solve = false;  ///< factors were switched, or nodes frozen, since then
  std::size_t loops_that_merge = kLoopsThatMerge;  ///< as the last solve had it
  NodeIndex frozen_nodes = 0;  ///< the first so many stay where they are: the frozen map
  ChunkedVector<StoredNode> nodes;
  ChunkedVector<Estimate> estimates;  ///< by node: T_map_body or p_map
  ChunkedVector<StoredFactor> factors;
  std::optional<Geodetic> datum;  ///< of all GNSS factors, where they have one: the map is there
};

}  // namespace cairn
