// SPDX-License-Identifier: BSD-3-Clause
#include "server/replay_journal.hpp"

#include "cairn/replay/estimate.hpp"

namespace cairn {
namespace {

Error broken(std::uint64_t number, const std::string& reason) {
  return {ErrorCode::kBadInput,
          reason + "; the journal was written by another version, or is damaged: run cairn verify",
          "record " + std::to_string(number)};
}

Result<void> apply(const TransactionRecord& record, const Revision& revision, MapHead& head,
                   Sequencer& sequencer) {
  if (const auto* refused = std::get_if<RefusedTransaction>(&record.outcome)) {
    head.advance(revision);
    sequencer.replay(refused->key, record.content_hash, refused->code, refused->reason, revision);
    return {};
  }
  const auto& transaction = std::get<Transaction>(record.outcome);
  if (const auto refusal = head.check(transaction)) return broken(revision.number, refusal->reason);
  head.apply(transaction, revision);
  sequencer.replay(transaction.key, record.content_hash, std::nullopt, "", revision);
  return {};
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
  return {};
}

}  // namespace

Result<void> replay_journal(const Journal& journal, MapHead& head, Sequencer& sequencer) {
  const std::uint64_t store = journal.head().revision.store;
  return journal.for_each(1, [&](const Record& record) -> Result<void> {
    const Revision revision{store, record.era, record.number};
    if (const auto* transaction = std::get_if<TransactionRecord>(&record.body))
      return apply(*transaction, revision, head, sequencer);
    if (const auto* solve = std::get_if<SolveRecord>(&record.body))
      return apply(*solve, revision, head);
    head.advance(revision);  // commands and verdicts do not change the map yet
    return {};
  });
}

RecordBody record_of(Decision&& decision, std::int64_t arrival_ns) {
  TransactionRecord record;
  record.content_hash = decision.content_hash;
  record.arrival_ns = arrival_ns;
  if (decision.refusal) {
    record.outcome =
        RefusedTransaction{decision.transaction.key, *decision.refusal, std::move(decision.reason)};
  } else {
    record.outcome = std::move(decision.transaction);
  }
  return record;
}

}  // namespace cairn
