// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/apply_record.hpp"

#include "cairn/history/order.hpp"
#include "cairn/history/record_json.hpp"
#include "cairn/history/solve_record.hpp"
#include "cairn/replay/estimate.hpp"

namespace cairn {
namespace {

Error broken(std::uint64_t number, const std::string& reason) {
  return {ErrorCode::kBadInput,
          reason + "; the journal was written by another version, or is damaged: run cairn verify",
          "record " + std::to_string(number)};
}

Result<void> apply(const TransactionRecord& record, const Revision& revision, MapHead& head) {
  const auto* transaction = std::get_if<Transaction>(&record.outcome);
  if (transaction == nullptr) {
    head.advance(revision);
    return {};
  }
  if (const auto refusal = head.check(*transaction))
    return broken(revision.number, refusal->reason);
  head.apply(*transaction, revision);
  return {};
}

void commit_what_no_gate_saw(const SolveRecord& record, const Revision& base, MapHead& head) {
  if (SolveSettings::parse(record.settings).ungated()) head.commit_loops(base);
}

void note_method(const SolveRecord& record, MapHead& head) {
  if (const auto method = SolveSettings::parse(record.settings).known())
    head.set_loops_that_merge(method->loops_that_merge);
}

Result<void> apply(const SolveRecord& record, const Revision& revision, MapHead& head) {
  std::vector<std::pair<NodeIndex, Estimate>> changed;
  changed.reserve(record.changed.size());
  for (const ChangedEstimate& estimate : record.changed) {
    const auto node = head.find(estimate.node);
    if (!node) return broken(revision.number, "no node " + to_string(estimate.node));
    changed.emplace_back(*node, to_estimate(estimate.numbers));
  }
  Revision base = revision;
  base.number = record.base;
  head.apply_estimates(changed, base, revision);
  note_method(record, head);
  commit_what_no_gate_saw(record, base, head);
  return {};
}

Result<void> apply(const VerdictRecord& record, const Revision& revision, MapHead& head) {
  const auto factor = head.find(record.factor);
  if (!factor) return broken(revision.number, "no factor " + to_string(record.factor));
  head.judge(*factor, record.state, revision);
  return {};
}

Result<void> apply(const CommandRecord& record, const Revision& revision, MapHead& head) {
  const auto order = order_of(record);
  if (!order) return broken(revision.number, order.error().message);
  const Order changes = *order ? **order : Order();
  if (const auto refusal = head.check(changes.edits))
    return broken(revision.number, refusal->reason);
  if (changes.frozen && changes.frozen->after > head.graph().nodes.size())
    return broken(revision.number, "it freezes more nodes than there are");
  apply(changes, revision, head);
  return {};
}

}  // namespace

Result<void> apply_record(const Record& record, std::uint64_t store, MapHead& head) {
  const Revision revision{store, record.era, record.number};
  if (const auto* transaction = std::get_if<TransactionRecord>(&record.body))
    return apply(*transaction, revision, head);
  if (const auto* solve = std::get_if<SolveRecord>(&record.body))
    return apply(*solve, revision, head);
  if (const auto* command = std::get_if<CommandRecord>(&record.body))
    return apply(*command, revision, head);
  return apply(std::get<VerdictRecord>(record.body), revision, head);
}

Result<void> apply_beside_estimates(const Record& record, std::uint64_t store, MapHead& head) {
  const auto* solve = std::get_if<SolveRecord>(&record.body);
  if (solve == nullptr) return apply_record(record, store, head);
  commit_what_no_gate_saw(*solve, {store, record.era, solve->base}, head);
  note_method(*solve, head);
  head.pass_over({store, record.era, record.number});
  return {};
}

Result<std::vector<PoseGraph>> maps_at(const Journal& journal,
                                       const std::vector<std::uint64_t>& numbers,
                                       const KeepGoing& keep_going) {
  const Revision end = journal.head().revision;
  if (numbers.back() > end.number) {
    return Error{ErrorCode::kUsage, "there is no revision " + std::to_string(numbers.back()) +
                                        "; the newest is " + std::to_string(end.number)};
  }
  MapHead head;
  std::vector<PoseGraph> maps;
  const Error stop{ErrorCode::kInternal, "interrupted"};
  const auto collect = [&](std::uint64_t number) {
    while (maps.size() < numbers.size() && numbers[maps.size()] == number)
      maps.push_back(head.graph());
    return maps.size() == numbers.size();
  };
  if (collect(0)) return maps;
  const Result<void> walked = journal.for_each(1, [&](const Record& record) -> Result<void> {
    if (keep_going && !keep_going()) return stop;
    if (Result<void> applied = apply_record(record, end.store, head); !applied) return applied;
    return collect(record.number) ? Result<void>(stop) : Result<void>();
  });
  if (maps.size() < numbers.size()) return walked ? stop : walked.error();
  return maps;
}

}  // namespace cairn
