// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/solve_record.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <iterator>

#include "cairn/linear/platform.hpp"
#include "cairn/replay/settle.hpp"

namespace cairn {
namespace {

// By SolveKind; "gate N": N loops merge.
constexpr std::string_view kMethods[] = {
    "lm, multifrontal, portable, initialization auto, gate ",
    "lm, multifrontal, portable, initialization auto, quick gate ",
    "lm, multifrontal, portable, initialization auto",
    "lm, multifrontal, portable, initialization auto, changes over 1e-6",
};
constexpr std::string_view kLiveChanges = ", changes over 1e-6";

bool is_live(SolveKind kind) { return kind == SolveKind::kLive || kind == SolveKind::kUngatedLive; }
bool is_gated(SolveKind kind) { return kind == SolveKind::kSettled || kind == SolveKind::kLive; }
constexpr char kSeparator[] = "; ";

}  // namespace

SolveSettings SolveSettings::here(const SolveMethod& method) {
  std::string text(kMethods[static_cast<int>(method.kind)]);
  if (is_gated(method.kind)) text += std::to_string(method.loops_that_merge);
  if (method.kind == SolveKind::kLive) text += kLiveChanges;
  return {std::move(text), describe_platform()};
}

std::optional<SolveMethod> SolveSettings::known() const {
  for (const SolveKind kind : {SolveKind::kUngated, SolveKind::kUngatedLive})
    if (method == kMethods[static_cast<int>(kind)]) return SolveMethod{kind};
  for (const SolveKind kind : {SolveKind::kSettled, SolveKind::kLive}) {
    const std::string_view name = kMethods[static_cast<int>(kind)];
    if (!method.starts_with(name)) continue;
    SolveMethod found{kind, 0};
    const char* const end = method.data() + method.size();
    const auto [rest, error] =
        std::from_chars(method.data() + name.size(), end, found.loops_that_merge);
    if (error == std::errc() && method == here(found).method) return found;
  }
  return std::nullopt;
}

bool SolveSettings::ungated() const {
  const auto known_method = known();
  return known_method && !is_gated(known_method->kind);
}

MapSolution solve_as(const SolveMethod& method, const PoseGraph& map, SettleOptions options) {
  options.loops_that_merge = method.loops_that_merge;
  options.gate = method.kind == SolveKind::kSettled ? Gate::kWhole
                 : method.kind == SolveKind::kLive  ? Gate::kQuick
                                                    : Gate::kOpen;
  return solve_map(map, options);
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
                                       const MapSolution& solution, Revision next,
                                       const SolveMethod& method) {
  std::vector<RecordBody> records;
  for (VerdictRecord& verdict : verdict_records(head.graph(), solution))
    records.emplace_back(std::move(verdict));
  for (const LoopVerdict& verdict : solution.verdicts) {
    head.judge(verdict.factor, verdict.state, next);
    ++next.number;
  }
  const auto changed = kept_changes(head.graph(), solution, method.kind);
  SolveRecord record;
  record.base = base.number;
  record.settings = SolveSettings::here(method).to_string();
  record.start = "as sent";
  for (const auto& [node, estimate] : changed) {
    const StoredNode& stored = head.graph().nodes[node];
    const auto* numbers = estimate.data();
    record.changed.push_back({stored.id, stored.type, {numbers, numbers + stored.start.size()}});
  }
  head.apply_estimates(changed, base, next);
  head.set_loops_that_merge(method.loops_that_merge);
  if (!is_gated(method.kind)) head.commit_loops(base);
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
