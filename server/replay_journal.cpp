// SPDX-License-Identifier: BSD-3-Clause
#include "server/replay_journal.hpp"

#include "cairn/replay/estimate.hpp"
#include "cairn/replay/estimate_snapshot.hpp"

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

struct TakenSnapshot {
  std::uint64_t number;
  EstimateSnapshot content;
};

// One of an older format is as good as none.
std::optional<TakenSnapshot> take_snapshot(const Journal& journal) {
  const std::optional<Journal::Snapshot> stored = journal.newest_snapshot();
  if (!stored) return std::nullopt;
  Result<EstimateSnapshot> content = decode_snapshot(stored->bytes);
  if (!content) return std::nullopt;
  return TakenSnapshot{stored->number, std::move(*content)};
}

Result<void> restore(const TakenSnapshot& snapshot, MapHead& head) {
  if (snapshot.content.estimates.size() != head.graph().nodes.size())
    return broken(snapshot.number, "the snapshot after it is of another map");
  head.restore_estimates(snapshot.content.estimates, snapshot.content.solved);
  return {};
}

}  // namespace

Result<Replayed> replay_journal(const Journal& journal, MapHead& head, Sequencer& sequencer,
                                const std::function<void()>& on_record) {
  const JournalHead end = journal.head();
  const std::optional<TakenSnapshot> snapshot = take_snapshot(journal);
  const Result<void> replayed = journal.for_each(1, [&](const Record& record) -> Result<void> {
    if (on_record) on_record();
    const Revision revision{end.revision.store, record.era, record.number};
    const bool covered = snapshot && record.number <= snapshot->number;
    Result<void> applied;
    if (const auto* transaction = std::get_if<TransactionRecord>(&record.body)) {
      applied = apply(*transaction, revision, head, sequencer);
    } else if (const auto* solve = std::get_if<SolveRecord>(&record.body); solve && !covered) {
      applied = apply(*solve, revision, head);
    } else {
      head.advance(revision);  // commands and verdicts do not change the map yet
    }
    if (!applied || !snapshot || record.number != snapshot->number) return applied;
    return restore(*snapshot, head);
  });
  if (!replayed) return replayed.error();
  if (!snapshot) return Replayed{};
  Replayed result{.snapshot = snapshot->number};
  if (snapshot->number == end.revision.number) result.chi2 = snapshot->content.chi2;
  return result;
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
