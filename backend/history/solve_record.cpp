// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/solve_record.hpp"

#include <algorithm>
#include <cstdio>
#include <iterator>

#include "cairn/linear/platform.hpp"
#include "cairn/replay/settle.hpp"

namespace cairn {
namespace {

// By SolveKind.
constexpr const char* kMethods[] = {
    "lm, multifrontal, portable, initialization auto, gate 3",
    "lm, multifrontal, portable, initialization auto, quick gate 3, changes over 1e-6",
    "lm, multifrontal, portable, initialization auto",
    "lm, multifrontal, portable, initialization auto, changes over 1e-6",
};
static_assert(kLoopsThatMerge == 3, "it stands in the names of methods");

bool is_live(SolveKind kind) { return kind == SolveKind::kLive || kind == SolveKind::kUngatedLive; }
constexpr char kSeparator[] = "; ";

}  // namespace

SolveSettings SolveSettings::here(SolveKind kind) {
  return {kMethods[static_cast<int>(kind)], describe_platform()};
}

std::optional<SolveKind> SolveSettings::kind() const {
  const auto found = std::find(std::begin(kMethods), std::end(kMethods), method);
  if (found == std::end(kMethods)) return std::nullopt;
  return static_cast<SolveKind>(found - std::begin(kMethods));
}

bool SolveSettings::ungated() const {
  const auto known = kind();
  return known && (*known == SolveKind::kUngated || *known == SolveKind::kUngatedLive);
}

MapSolution solve_as(SolveKind kind, const PoseGraph& map,
                     const std::function<bool()>& keep_going) {
  switch (kind) {
    case SolveKind::kSettled:
      return solve_map(map, Gate::kWhole, keep_going);
    case SolveKind::kLive:
      return solve_map(map, Gate::kQuick, keep_going);
    case SolveKind::kUngated:
    case SolveKind::kUngatedLive:
      break;
  }
  return solve_map(map, Gate::kOpen, keep_going);
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
  return changed_estimates(map, solution.estimates, is_live(kind) ? kLiveTolerance : 0.0);
}

bool is_news(const PoseGraph& map, const MapSolution& solution, SolveKind kind,
             std::uint64_t last_input_at_base) {
  return map.solved_revision.number < last_input_at_base || !solution.verdicts.empty() ||
         !kept_changes(map, solution, kind).empty();
}

std::vector<VerdictRecord> verdict_records(const PoseGraph& map, const MapSolution& solution) {
  std::vector<VerdictRecord> records;
  for (const LoopVerdict& verdict : solution.verdicts) {
    VerdictRecord record{.factor = map.factors[verdict.factor].name,
                         .test = verdict.test,
                         .value = verdict.value,
                         .threshold = verdict.threshold,
                         .disagreeing = {},
                         .state = verdict.state};
    for (const std::uint32_t other : verdict.against)
      record.disagreeing.push_back(map.factors[other].name);
    records.push_back(std::move(record));
  }
  return records;
}

std::vector<RecordBody> apply_solution(MapHead& head, const Revision& base,
                                       const MapSolution& solution, Revision next, SolveKind kind) {
  std::vector<RecordBody> records;
  for (VerdictRecord& verdict : verdict_records(head.graph(), solution))
    records.emplace_back(std::move(verdict));
  for (const LoopVerdict& verdict : solution.verdicts) {
    head.judge(verdict.factor, verdict.state, next);
    ++next.number;
  }
  const auto changed = kept_changes(head.graph(), solution, kind);
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
  if (SolveSettings::here(kind).ungated()) head.commit_loops(base);
  record.estimates_hash = hash_estimates(head.graph());
  records.emplace_back(std::move(record));
  return records;
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
