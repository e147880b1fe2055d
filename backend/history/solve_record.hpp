// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cairn/journal/record.hpp"
#include "cairn/replay/map_head.hpp"
#include "cairn/replay/solve_map.hpp"

namespace cairn {

/// What is kept of a solve.
enum class SolveKind {
  kSettled,  ///< every bit: the map is the settled estimate
  kLive,  ///< while input goes on, changes over kLiveTolerance: the others would fill the journal
};
constexpr double kLiveTolerance = 1e-6;  ///< m, rad, parts of a quaternion

/// The method of settle(), what is kept, and how numbers round here: "METHOD; PLATFORM". Solves
/// with the same text give the same bits.
struct SolveSettings {
  std::string method;
  std::string platform;  ///< empty in records of early versions

  static SolveSettings here(SolveKind kind = SolveKind::kSettled);
  static SolveSettings parse(const std::string& text);
  [[nodiscard]] std::string to_string() const { return method + "; " + platform; }
  /// Nothing where this version does not know the method.
  [[nodiscard]] std::optional<SolveKind> kind() const;
  friend bool operator==(const SolveSettings&, const SolveSettings&) = default;
};

/// Of all estimates, in the order in which nodes arrived.
ContentHash hash_estimates(const PoseGraph& map);

/// What is kept of a solve, by node.
std::vector<std::pair<NodeIndex, Estimate>> kept_changes(const PoseGraph& map,
                                                         const MapSolution& solution,
                                                         SolveKind kind);

/// Takes what is kept of a solve of the map at `base` into the head, as revision `next`. Gives its
/// record.
SolveRecord apply_solve(MapHead& head, const Revision& base,
                        const std::vector<std::pair<NodeIndex, Estimate>>& changed,
                        const Revision& next, SolveKind kind = SolveKind::kSettled);

/// "settled at REVISION, chi2 X": the answer to `settle`.
std::string settled_text(const Revision& revision, double chi2);
/// Why a solve changed nothing, and what to do: the answer where it is not usable.
std::string unsettled_text(const SolveSummary& summary);

}  // namespace cairn
