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

/// How thoroughly a map is solved, and what is kept of it.
enum class SolveKind {
  kSettled,  ///< every loop closure is judged anew, every bit is kept: the settled estimate
  kLive,     ///< while input goes on: the quick gate, changes over kLiveTolerance (the others would
             ///< fill the journal)
  kUngated,  ///< of early journals: as kSettled, with every loop closure in it
  kUngatedLive,  ///< and as kLive
};
constexpr double kLiveTolerance = 1e-6;  ///< m, rad, parts of a quaternion

/// What decides, beside the map, what a solve finds: it stands in the solve's record.
struct SolveMethod {
  SolveKind kind = SolveKind::kSettled;
  std::size_t loops_that_merge = kLoopsThatMerge;

  friend bool operator==(const SolveMethod&, const SolveMethod&) = default;
};

/// The method of settle(), what is kept, and how numbers round here: "METHOD; PLATFORM". Solves
/// with the same text give the same bits.
struct SolveSettings {
  std::string method;
  std::string platform;  ///< empty in records of early versions

  static SolveSettings here(const SolveMethod& method = {});
  static SolveSettings parse(const std::string& text);
  [[nodiscard]] std::string to_string() const { return method + "; " + platform; }
  /// Nothing where this version does not know the method.
  [[nodiscard]] std::optional<SolveMethod> known() const;
  /// Its estimates have every loop closure in them.
  [[nodiscard]] bool ungated() const;
  friend bool operator==(const SolveSettings&, const SolveSettings&) = default;
};

/// Of all estimates, in the order in which nodes arrived.
ContentHash hash_estimates(const PoseGraph& map);

/// solve_map() by that method; the method decides which gate is asked and how many loops merge.
MapSolution solve_as(const SolveMethod& method, const PoseGraph& map, SettleOptions options = {});

/// What is kept of a solve, by node.
std::vector<std::pair<NodeIndex, Estimate>> kept_changes(const PoseGraph& map,
                                                         const MapSolution& solution,
                                                         SolveKind kind);

/// The verdicts of a solve, as records.
std::vector<VerdictRecord> verdict_records(const PoseGraph& map, const MapSolution& solution);

/// Takes what is kept of a solve of the map at `base` into the head, from revision `next` on. Gives
/// its records, to be appended together: its verdicts, then the solve itself.
std::vector<RecordBody> apply_solution(MapHead& head, const Revision& base,
                                       const MapSolution& solution, Revision next,
                                       const SolveMethod& method = {});
/// Whether there is anything to apply: something changed, or input has come since the last solve.
bool is_news(const PoseGraph& map, const MapSolution& solution, SolveKind kind,
             std::uint64_t last_input_at_base);

/// "settled at REVISION, chi2 X": the answer to `settle`.
std::string settled_text(const Revision& revision, double chi2);
/// Why a solve changed nothing, and what to do: the answer where it is not usable.
std::string unsettled_text(const SolveSummary& summary);

}  // namespace cairn
