// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/solve_record.hpp"

#include <cstdio>

#include "cairn/linear/platform.hpp"
#include "cairn/replay/settle.hpp"

namespace cairn {
namespace {

constexpr char kSettled[] = "lm, multifrontal, portable, initialization auto";
constexpr char kLive[] = "lm, multifrontal, portable, initialization auto, changes over 1e-6";
constexpr char kSeparator[] = "; ";

}  // namespace

SolveSettings SolveSettings::here(SolveKind kind) {
  return {kind == SolveKind::kLive ? kLive : kSettled, describe_platform()};
}

std::optional<SolveKind> SolveSettings::kind() const {
  if (method == kSettled) return SolveKind::kSettled;
  if (method == kLive) return SolveKind::kLive;
  return std::nullopt;
}

SolveSettings SolveSettings::parse(const std::string& text) {
  const std::size_t at = text.find(kSeparator);
  if (at == std::string::npos) return {text, ""};
  return {text.substr(0, at), text.substr(at + sizeof kSeparator - 1)};
}

ContentHash hash_estimates(const PoseGraph& map) {
  std::string bytes;
  bytes.reserve(map.nodes.size() * sizeof(Estimate));
  for (NodeIndex i = 0; i < map.nodes.size(); ++i) {
    const Estimate& estimate = map.estimates[i];
    bytes.append(reinterpret_cast<const char*>(estimate.data()), sizeof(Estimate));
  }
  return content_hash(bytes);
}

std::vector<std::pair<NodeIndex, Estimate>> kept_changes(const PoseGraph& map,
                                                         const MapSolution& solution,
                                                         SolveKind kind) {
  return changed_estimates(map, solution.estimates,
                           kind == SolveKind::kLive ? kLiveTolerance : 0.0);
}

SolveRecord apply_solve(MapHead& head, const Revision& base,
                        const std::vector<std::pair<NodeIndex, Estimate>>& changed,
                        const Revision& next, SolveKind kind) {
  SolveRecord record;
  record.base = base.number;
  record.settings = SolveSettings::here(kind).to_string();
  record.start = "as sent";
  for (const auto& [node, estimate] : changed) {
    const StoredNode& stored = head.graph().nodes[node];
    const auto* numbers = estimate.data();
    record.changed.push_back({stored.id, stored.type, {numbers, numbers + stored.start.size()}});
  }
  head.apply_estimates(changed, base, next);
  record.estimates_hash = hash_estimates(head.graph());
  return record;
}

std::string settled_text(const Revision& revision, double chi2) {
  char number[32];
  std::snprintf(number, sizeof number, "%.9g", chi2);
  return "settled at " + to_string(revision) + ", chi2 " + number;
}

std::string unsettled_text(const SolveSummary& summary) {
  return "the map cannot be settled (" + std::string(to_string(summary.stop_reason)) +
         "), the last good estimate stays; cairn export graph --live writes the map, cairn check "
         "says what is wrong with it";
}

}  // namespace cairn
