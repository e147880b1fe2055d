// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "cairn/journal/record.hpp"
#include "cairn/replay/map_head.hpp"
#include "cairn/solver/solve_summary.hpp"

namespace cairn {

/// The method of settle(), and how numbers round here: "METHOD; PLATFORM". Solves with the same
/// text give the same bits.
struct SolveSettings {
  std::string method;
  std::string platform;  ///< empty in records of early versions

  static SolveSettings here();
  static SolveSettings parse(const std::string& text);
  [[nodiscard]] std::string to_string() const { return method + "; " + platform; }
  friend bool operator==(const SolveSettings&, const SolveSettings&) = default;
};

/// Of all estimates, in the order in which nodes arrived.
ContentHash hash_estimates(const PoseGraph& map);

/// Takes a solve of the map at `base` into the head, as revision `next`. Gives its record.
SolveRecord apply_solve(MapHead& head, const Revision& base,
                        const std::vector<std::pair<NodeIndex, Estimate>>& changed,
                        const Revision& next);

/// "settled at REVISION, chi2 X": the answer to `settle`.
std::string settled_text(const Revision& revision, double chi2);
/// Why a solve changed nothing, and what to do: the answer where it is not usable.
std::string unsettled_text(const SolveSummary& summary);

}  // namespace cairn
