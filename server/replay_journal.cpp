// SPDX-License-Identifier: BSD-3-Clause
#include "server/replay_journal.hpp"

#include "cairn/history/apply_record.hpp"
#include "cairn/replay/estimate_snapshot.hpp"

namespace cairn {
namespace {

void remember(const TransactionRecord& record, const Revision& revision, Sequencer& sequencer) {
  if (const auto* refused = std::get_if<RefusedTransaction>(&record.outcome))
    sequencer.replay(refused->key, record.content_hash, refused->code, refused->reason, revision);
  else
    sequencer.replay(record.key(), record.content_hash, std::nullopt, "", revision);
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
    return Error{ErrorCode::kBadInput,
                 "the snapshot of estimates after it is of another map; move the folder snapshots "
                 "away and start again",
                 "record " + std::to_string(snapshot.number)};
  head.restore_estimates(snapshot.content.estimates, snapshot.content.solved);
  return {};
}

void remember(const VerdictRecord& verdict, std::map<FactorName, VerdictRecord>& quarantined) {
  if (verdict.state == FactorState::kQuarantined)
    quarantined.insert_or_assign(verdict.factor, verdict);
  else
    quarantined.erase(verdict.factor);
}

}  // namespace

Result<Replayed> replay_journal(const Journal& journal, MapHead& head, Sequencer& sequencer,
                                const std::function<void()>& on_record) {
  const JournalHead end = journal.head();
  const std::optional<TakenSnapshot> snapshot = take_snapshot(journal);
  Replayed result;
  const Result<void> replayed = journal.for_each(1, [&](const Record& record) -> Result<void> {
    if (on_record) on_record();
    const Revision revision{end.revision.store, record.era, record.number};
    const bool covered = snapshot && record.number <= snapshot->number;
    const Result<void> applied = covered ? apply_beside_estimates(record, end.revision.store, head)
                                         : apply_record(record, end.revision.store, head);
    if (!applied) return applied;
    if (const auto* transaction = std::get_if<TransactionRecord>(&record.body))
      remember(*transaction, revision, sequencer);
    if (const auto* verdict = std::get_if<VerdictRecord>(&record.body))
      remember(*verdict, result.quarantined);
    if (!snapshot || record.number != snapshot->number) return {};
    return restore(*snapshot, head);
  });
  if (!replayed) return replayed.error();
  if (!snapshot) return result;
  result.snapshot = snapshot->number;
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
