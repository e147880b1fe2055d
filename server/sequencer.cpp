// SPDX-License-Identifier: BSD-3-Clause
#include "server/sequencer.hpp"

#include <algorithm>
#include <utility>

namespace cairn {
namespace {

std::string describe(RefusalCode code, const std::string& reason) {
  return std::string(to_string(code)) + ": " + reason;
}

}  // namespace

Sequencer::Sequencer(SequencerLimits limits)
    : limits_(limits),
      room_({limits.held - limits.held / 8, limits.held_bytes - limits.held_bytes / 8}),
      strangers_({limits.held / 8, limits.held_bytes / 8}) {}

void Sequencer::replay(const TransactionKey& key, const ContentHash& hash,
                       const std::optional<RefusalCode>& refusal, const std::string& reason,
                       const Revision& revision) {
  Source& source = open_epoch(key);
  source.ever_accepted |= !refusal;
  remember(source, key, {hash, {key, revision, refusal, reason}});
}

// The decision of a transaction of a new epoch closes the one before.
Sequencer::Source& Sequencer::open_epoch(const TransactionKey& key) {
  const bool known = knows(key.source);
  Source& source = sources_[key.source];
  if (known && source.epoch != key.epoch) {
    source.closed_epochs.insert(source.epoch);
    source.kept.clear();
    source.highest_decided = 0;
  }
  source.epoch = key.epoch;
  return source;
}

void Sequencer::remember(Source& source, const TransactionKey& key, Kept kept) {
  source.highest_decided = key.sequence;
  source.kept.emplace(key.sequence, std::move(kept));
  if (source.kept.size() > limits_.kept_decisions) source.kept.erase(source.kept.begin());
}

void Sequencer::count_refusal(const Receipt& receipt) {
  const auto source = sources_.find(receipt.key.source);
  if (source == sources_.end() || !receipt.refusal) return;
  ++source->second.refused[*receipt.refusal];
  source->second.last_refusal = describe(*receipt.refusal, receipt.reason);
}

void Sequencer::answer(const TransactionKey& key, RefusalCode code, const std::string& reason,
                       Turn& turn) {
  turn.outcome.answers.push_back({key, turn.head.graph().graph_revision, code, reason});
  count_refusal(turn.outcome.answers.back());
}

// Of a repetition.
const Receipt* Sequencer::first_receipt(const Source& source, const Arrival& arrival) const {
  const TransactionKey& key = arrival.transaction.key;
  if (key.epoch != source.epoch) return nullptr;
  const auto kept = source.kept.find(key.sequence);
  return kept != source.kept.end() && kept->second.hash == arrival.hash ? &kept->second.receipt
                                                                        : nullptr;
}

// Conflicts and what is stale need no decision.
std::optional<Refusal> Sequencer::refuse_at_once(const Source& source, const Arrival& arrival,
                                                 WaitingRoom& room) const {
  const TransactionKey& key = arrival.transaction.key;
  const std::string sequence = "sequence " + std::to_string(key.sequence);
  if (key.sequence == 0) return Refusal{RefusalCode::kMalformed, "sequences begin with 1"};
  if (source.closed_epochs.contains(key.epoch))
    return Refusal{RefusalCode::kStale,
                   "a newer epoch of this source has begun; send with a spool of its own"};
  if (key.epoch == source.epoch && key.sequence <= source.highest_decided) {
    if (source.kept.contains(key.sequence))
      return Refusal{
          RefusalCode::kConflict,
          sequence + " was decided with other content; a sequence names one transaction"};
    return Refusal{RefusalCode::kStale, sequence + " was decided long ago; kept are the last " +
                                            std::to_string(limits_.kept_decisions)};
  }
  if (key.epoch != source.epoch && source.closed_epochs.size() >= limits_.closed_epochs)
    return Refusal{RefusalCode::kOverBudget,
                   "this source has begun anew " + std::to_string(limits_.closed_epochs) +
                       " times, which is the limit; take another source name"};
  if (const auto* waiting = room.find(key.source, {key.epoch, key.sequence});
      waiting != nullptr && waiting->arrival.hash != arrival.hash)
    return Refusal{RefusalCode::kConflict,
                   sequence + " waits with other content; a sequence names one transaction"};
  return std::nullopt;
}

void Sequencer::take(Arrival arrival, Turn turn) {
  static const Source kStranger;
  const TransactionKey key = arrival.transaction.key;
  const auto known = sources_.find(key.source);
  const Source& source = known == sources_.end() ? kStranger : known->second;
  WaitingRoom& room = room_of(key.source);
  if (const Receipt* receipt = first_receipt(source, arrival)) {
    turn.outcome.answers.push_back(*receipt);
    return;
  }
  if (const auto refusal = refuse_at_once(source, arrival, room))
    return answer(key, refusal->code, refusal->reason, turn);
  if (room.find(key.source, {key.epoch, key.sequence}) != nullptr) return;  // waits already
  if (key.sequence == 1) openers_[key.source] = {key.epoch, 1};
  room.add(std::move(arrival), turn.now_ns);
  advance(key.source, turn);
  for (const Arrival& leaving : room_of(key.source).remove_excess(key.source)) {
    answer(leaving.transaction.key, RefusalCode::kOverBudget,
           "too many transactions wait for earlier ones or for other sources", turn);
  }
}

void Sequencer::skip_to(const std::string& source, std::uint64_t epoch, std::uint64_t first,
                        Turn turn) {
  const auto known = sources_.find(source);
  if (known == sources_.end() || known->second.epoch != epoch)
    openers_[source] = {epoch, first};
  else if (known->second.highest_decided + 1 < first)
    known->second.highest_decided = first - 1;
  advance(source, turn);
}

// Decides what is next of this source, and then, as it may have brought what others wait for, of
// everybody, until nothing moves.
void Sequencer::advance(const std::string& name, Turn& turn) {
  bool moved = false;
  while (advance_one(name, turn)) moved = true;
  while (moved) {
    moved = false;
    for (const std::string& other : std::set<std::string>(awaiting_))
      while (advance_one(other, turn)) moved = true;
  }
}

// The current epoch goes first; another one begins with its sequence 1, or what is left of it.
std::optional<WaitingRoom::Place> Sequencer::next_of(const std::string& name) {
  WaitingRoom& room = room_of(name);
  if (const auto source = sources_.find(name); source != sources_.end()) {
    const WaitingRoom::Place next{source->second.epoch, source->second.highest_decided + 1};
    if (room.find(name, next) != nullptr) return next;
  }
  const auto opener = openers_.find(name);
  if (opener == openers_.end()) return std::nullopt;
  if (room.find(name, opener->second) != nullptr) return opener->second;
  return std::nullopt;
}

bool Sequencer::advance_one(const std::string& name, Turn& turn) {
  const auto place = next_of(name);
  awaiting_.erase(name);
  if (!place) return false;
  WaitingRoom& room = room_of(name);
  WaitingRoom::Waiting& first = *room.find(name, *place);
  std::optional<Refusal> refusal =
      first.arrival.fault ? first.arrival.fault : turn.head.check(first.arrival.transaction);
  if (refusal && refusal->awaited && turn.now_ns - first.since_ns < limits_.patience_ns) {
    first.awaited = refusal->awaited;
    awaiting_.insert(name);
    return false;
  }
  const auto full = no_room_for(name, !refusal);
  Arrival arrival = room.remove(name, *place).arrival;
  if (full)
    answer(arrival.transaction.key, full->code, full->reason, turn);
  else
    decide(name, std::move(arrival), std::move(refusal), turn);
  return !full;
}

// A decision makes a stranger known for ever, so there is a limit. Whoever sends nothing but
// refusals meets it first.
std::optional<Refusal> Sequencer::no_room_for(const std::string& name, bool accepted) const {
  if (knows(name)) return std::nullopt;
  if (sources_.size() >= limits_.sources)
    return Refusal{RefusalCode::kOverBudget, "the daemon knows " + std::to_string(limits_.sources) +
                                                 " sources, which is the limit"};
  const auto refused = static_cast<std::size_t>(
      std::count_if(sources_.begin(), sources_.end(),
                    [](const auto& known) { return !known.second.ever_accepted; }));
  if (accepted || refused < limits_.never_accepted) return std::nullopt;
  return Refusal{RefusalCode::kOverBudget,
                 "too many sources have sent nothing that could be accepted, like this one"};
}

void Sequencer::decide(const std::string& name, Arrival arrival, std::optional<Refusal> refusal,
                       Turn& turn) {
  Revision revision = turn.next;
  revision.number += turn.outcome.decisions.size();
  const TransactionKey key = arrival.transaction.key;
  WaitingRoom::Line line;
  const bool begins = !knows(name) || sources_.at(name).epoch != key.epoch;
  if (begins) line = room_of(name).remove_line(name);
  Source& source = open_epoch(key);
  Decision decision;
  decision.content_hash = arrival.hash;
  if (refusal) {
    decision.refusal = refusal->code;
    decision.reason = refusal->reason;
    decision.transaction.key = key;
    turn.head.advance(revision);
  } else {
    turn.head.apply(arrival.transaction, revision);
    decision.transaction = std::move(arrival.transaction);
    source.ever_accepted = true;
    ++source.accepted;
  }
  Receipt receipt{key, revision, decision.refusal, decision.reason};
  count_refusal(receipt);
  remember(source, key, {arrival.hash, std::move(receipt)});
  turn.outcome.decisions.push_back(std::move(decision));
  if (!begins) return;
  openers_.erase(name);
  for (auto at = line.begin(); at != line.end();) {
    if (at->first.epoch != key.epoch && source.closed_epochs.contains(at->first.epoch)) {
      answer(at->second.arrival.transaction.key, RefusalCode::kStale,
             "a newer epoch of this source has begun", turn);
      at = line.erase(at);
    } else {
      ++at;
    }
  }
  room_.adopt(name, std::move(line));
}

void Sequencer::expire(Turn turn) {
  for (const std::string& name : std::set<std::string>(awaiting_)) {
    const auto place = next_of(name);
    if (!place || turn.now_ns - room_of(name).find(name, *place)->since_ns >= limits_.patience_ns)
      advance(name, turn);
  }
}

std::vector<Receipt> Sequencer::turn_away(RefusalCode code, const std::string& reason,
                                          const Revision& head) {
  std::vector<Receipt> receipts;
  for (WaitingRoom* room : {&room_, &strangers_})
    for (const std::string& name : room->sources())
      for (const auto& [place, waiting] : room->remove_line(name))
        receipts.push_back({waiting.arrival.transaction.key, head, code, reason});
  awaiting_.clear();
  openers_.clear();
  return receipts;
}

std::vector<Receipt> Sequencer::turn_away_stranger(const std::string& source,
                                                   const Revision& head) {
  std::vector<Receipt> receipts;
  if (knows(source)) return receipts;
  for (const auto& [place, waiting] : strangers_.remove_line(source))
    receipts.push_back({waiting.arrival.transaction.key, head, RefusalCode::kOverBudget,
                        "too many sources are there of which nothing was decided yet"});
  awaiting_.erase(source);
  openers_.erase(source);
  return receipts;
}

std::uint64_t Sequencer::highest_decided(const std::string& source, std::uint64_t epoch) const {
  const auto known = sources_.find(source);
  return known != sources_.end() && known->second.epoch == epoch ? known->second.highest_decided
                                                                 : 0;
}

bool Sequencer::is_closed(const std::string& source, std::uint64_t epoch) const {
  const auto known = sources_.find(source);
  return known != sources_.end() && known->second.closed_epochs.contains(epoch);
}

std::map<std::string, SourceCounters> Sequencer::counters() const {
  std::map<std::string, SourceCounters> all;
  for (const auto& [name, source] : sources_) {
    SourceCounters& counters = all[name];
    counters = {source.epoch,         source.highest_decided, source.accepted, 0,
                room_.count_of(name), source.last_refusal,    source.refused};
    for (const auto& [code, count] : source.refused) counters.refused += count;
  }
  return all;
}

}  // namespace cairn
