// SPDX-License-Identifier: BSD-3-Clause
#include "server/sequencer.hpp"

#include <algorithm>

namespace cairn {
namespace {

Receipt refusal_of(const TransactionKey& key, const Revision& head, RefusalCode code,
                   std::string reason) {
  return {key, head, code, std::move(reason)};
}

}  // namespace

void Sequencer::replay(const TransactionKey& key, const ContentHash& hash,
                       const std::optional<RefusalCode>& refusal, const std::string& reason,
                       const Revision& revision) {
  Source& source = sources_[key.source];
  if (source.epoch != key.epoch) {
    if (source.highest_decided > 0) source.closed_epochs.push_back(source.epoch);
    source.epoch = key.epoch;
    source.kept.clear();
    source.highest_decided = 0;
  }
  remember(source, key, {hash, {key, revision, refusal, reason}});
}

void Sequencer::remember(Source& source, const TransactionKey& key, Kept kept) {
  source.highest_decided = key.sequence;
  source.kept.emplace(key.sequence, std::move(kept));
  if (source.kept.size() > limits_.kept_decisions) source.kept.erase(source.kept.begin());
}

std::size_t Sequencer::held_count() const {
  std::size_t count = 0;
  for (const auto& [name, source] : sources_) count += source.held.size();
  return count;
}

// Repetitions, conflicts and what is stale need no decision.
std::optional<Receipt> Sequencer::answer_at_once(Source& source, const Transaction& transaction,
                                                 const ContentHash& hash,
                                                 const Revision& head) const {
  const TransactionKey& key = transaction.key;
  if (std::find(source.closed_epochs.begin(), source.closed_epochs.end(), key.epoch) !=
      source.closed_epochs.end())
    return refusal_of(key, head, RefusalCode::kStale,
                      "a newer epoch of this source has begun; send with a spool of its own");
  if (key.epoch != source.epoch || key.sequence > source.highest_decided) return std::nullopt;
  const auto kept = source.kept.find(key.sequence);
  if (kept == source.kept.end()) {
    return refusal_of(key, head, RefusalCode::kStale,
                      "sequence " + std::to_string(key.sequence) +
                          " was decided long ago; kept are the last " +
                          std::to_string(limits_.kept_decisions));
  }
  if (kept->second.hash == hash) return kept->second.receipt;
  return refusal_of(key, head, RefusalCode::kConflict,
                    "sequence " + std::to_string(key.sequence) +
                        " was decided with other content; a sequence names one transaction");
}

// False where there is no room: the source's share is an equal part of the whole.
bool Sequencer::hold(Source& source, Transaction&& transaction, const ContentHash& hash,
                     std::int64_t now_ns) {
  const std::size_t share = limits_.held / std::max<std::size_t>(sources_.size(), 1);
  if (source.held.size() >= std::max<std::size_t>(share, 1) || held_count() >= limits_.held)
    return false;
  const std::uint64_t sequence = transaction.key.sequence;
  source.held.emplace(sequence, Held{std::move(transaction), hash, now_ns, std::nullopt});
  return true;
}

void Sequencer::take(Transaction transaction, std::int64_t now_ns, MapHead& head, Revision next,
                     Outcome& outcome) {
  const TransactionKey key = transaction.key;
  const ContentHash hash = content_hash(encode(transaction));
  Source& source = sources_[key.source];
  if (source.epoch == 0 && source.highest_decided == 0) source.epoch = key.epoch;
  if (auto receipt = answer_at_once(source, transaction, hash, head.graph().graph_revision)) {
    outcome.answers.push_back({std::move(*receipt)});
    return;
  }
  if (key.sequence == 0) {
    outcome.answers.push_back({refusal_of(key, head.graph().graph_revision, RefusalCode::kMalformed,
                                          "sequences begin with 1")});
    return;
  }
  if (key.epoch != source.epoch) {  // the spool was lost, or is another one: what was held is gone
    source.closed_epochs.push_back(source.epoch);
    source.epoch = key.epoch;
    source.highest_decided = 0;
    source.kept.clear();
    source.held.clear();
  }
  if (source.held.contains(key.sequence)) return;  // a repetition of what waits already
  if (!hold(source, std::move(transaction), hash, now_ns)) {
    outcome.answers.push_back(
        {refusal_of(key, head.graph().graph_revision, RefusalCode::kOverBudget,
                    "too many transactions wait for earlier ones or for other sources")});
    return;
  }
  advance(key.source, now_ns, head, next, outcome);
}

// Decides what is next of this source, and then, as it may have brought what others wait for, of
// everybody, until nothing moves.
void Sequencer::advance(const std::string& name, std::int64_t now_ns, MapHead& head, Revision next,
                        Outcome& outcome) {
  bool moved = false;
  while (advance_one(name, now_ns, head, next, outcome)) moved = true;
  while (moved) {
    moved = false;
    for (auto& [other, source] : sources_) {
      if (source.held.empty() || !source.held.begin()->second.awaited) continue;
      while (advance_one(other, now_ns, head, next, outcome)) moved = true;
    }
  }
}

bool Sequencer::advance_one(const std::string& name, std::int64_t now_ns, MapHead& head,
                            Revision next, Outcome& outcome) {
  Source& source = sources_[name];
  if (source.held.empty()) return false;
  const auto first = source.held.begin();
  if (first->first != source.highest_decided + 1) return false;
  std::optional<Refusal> refusal = head.check(first->second.transaction);
  if (refusal && refusal->awaited && now_ns - first->second.since_ns < limits_.patience_ns) {
    first->second.awaited = refusal->awaited;
    return false;
  }
  Held held = std::move(first->second);
  source.held.erase(first);
  decide(source, std::move(held), std::move(refusal), head, next, outcome);
  return true;
}

void Sequencer::decide(Source& source, Held held, std::optional<Refusal> refusal, MapHead& head,
                       Revision next, Outcome& outcome) {
  Revision revision = next;
  revision.number += outcome.decisions.size();
  const TransactionKey key = held.transaction.key;
  Decision decision;
  decision.content_hash = held.hash;
  if (refusal) {
    decision.refusal = refusal->code;
    decision.reason = refusal->reason;
    decision.transaction.key = key;
    head.advance(revision);
    ++source.refused;
    source.last_refusal = std::string(to_string(refusal->code)) + ": " + refusal->reason;
  } else {
    head.apply(held.transaction, revision);
    decision.transaction = std::move(held.transaction);
    ++source.accepted;
  }
  remember(source, key, {held.hash, {key, revision, decision.refusal, decision.reason}});
  outcome.decisions.push_back(std::move(decision));
}

void Sequencer::expire(std::int64_t now_ns, MapHead& head, Revision next, Outcome& outcome) {
  std::vector<std::string> waiting;
  for (const auto& [name, source] : sources_) {
    if (!source.held.empty() && source.held.begin()->second.awaited &&
        now_ns - source.held.begin()->second.since_ns >= limits_.patience_ns)
      waiting.push_back(name);
  }
  for (const std::string& name : waiting) advance(name, now_ns, head, next, outcome);
}

std::map<std::string, SourceCounters> Sequencer::counters() const {
  std::map<std::string, SourceCounters> all;
  for (const auto& [name, source] : sources_) {
    all[name] = {source.epoch,   source.highest_decided, source.accepted,
                 source.refused, source.held.size(),     source.last_refusal};
  }
  return all;
}

}  // namespace cairn
