// SPDX-License-Identifier: BSD-3-Clause
// Clients that come and go, and what they know that the store has lost.
#include <tuple>

#include "server/service.hpp"

namespace cairn {
namespace {

constexpr int kMostErasRaised = 8;  // by clients in one run: a store loses its end before it only
constexpr std::uint32_t kMostEra = 1u << 31;

bool is_above(const Revision& promised, const Revision& head) {
  return promised.store == head.store &&
         std::tie(promised.era, promised.number) > std::tie(head.era, head.number);
}

}  // namespace

// A client sends nothing before it knows what was decided.
void Service::greet(const ClientState& client) {
  const JournalHead head = journal_.head();
  transport_.publish(SourceState{client.source, client.epoch,
                                 sequencer_.highest_decided(client.source, client.epoch),
                                 head.revision, head.chain, started_ns_});
  state_changed_ = true;
}

// Before anything that came after it is decided: what it was promised may change the era. What was
// said to another run of the daemon may be old: the middleware keeps it.
void Service::meet(const Seen& seen, Sequencer::Outcome& outcome) {
  if (seen.client.daemon_ns != started_ns_)
    return writers_.hear_of({seen.client.source, seen.client.epoch});
  if (!writers_.arrive(seen.client, seen.sender)) return;
  const ClientState& client = seen.client;
  if (sequencer_.is_closed(client.source, client.epoch)) return;  // its promises were kept
  const std::uint64_t decided = sequencer_.highest_decided(client.source, client.epoch);
  if (client.highest_decided > decided ||
      is_above(client.receipted, head_.graph().graph_revision)) {
    commit(std::exchange(outcome, {}));
    hear_promise(client);
  }
  if (client.oldest_kept <= decided + 1) return;
  announce(Severity::kError, "damage",
           "neither the store nor the spool of source " + client.source + " has its sequences " +
               std::to_string(decided + 1) + " to " + std::to_string(client.oldest_kept - 1) +
               "; restore a backup, or go on without them",
           journal_.head().revision);
  sequencer_.skip_to(client.source, client.epoch, client.oldest_kept, turn(outcome));
}

// The client holds receipts of what the store does not have.
void Service::hear_promise(const ClientState& client) {
  const Revision head = journal_.head().revision;
  const Refill::Clock::time_point now = Refill::Clock::now();
  const std::uint64_t decided = sequencer_.highest_decided(client.source, client.epoch);
  const OpenReport& opening = journal_.open_report();
  // The lost record's number may have been given to another one since. Names can be invented: one
  // that the journal does not know has lost nothing in a store that was whole.
  const bool can_have_lost = decided > 0 || opening.damage || opening.cut_tail;
  const bool replaced = can_have_lost && client.receipted.store == head.store &&
                        client.receipted.era == head.era && client.highest_decided > decided;
  if (is_above(client.receipted, head) || replaced) {
    if (client.receipted.era >= kMostEra || ++eras_raised_ > kMostErasRaised) return;
    if (auto raised = journal_.raise_era(client.receipted.era); !raised)
      return fail(raised.error());
    head_.advance(journal_.head().revision);
    refill_.begin(now);
    damage_ = "the store ends at " + to_string(head) + ", but source " + client.source +
              " has a receipt of " + to_string(client.receipted) +
              ": what lies between is lost here; clients send theirs again from their spools, "
              "operators must give their orders of that time again";
    announce(Severity::kError, "damage", damage_, journal_.head().revision);
    publish_estimate();
    for (const auto& [source, owner] : writers_.owners())
      if (owner.alive) greet(owner.state);
  }
  // Of an era that goes on nothing is lost, whatever a client says.
  const bool ended =
      client.receipted.store == head.store && client.receipted.era < journal_.head().revision.era;
  if (ended && client.highest_decided > decided && client.oldest_kept <= client.highest_decided)
    refill_.expect({client.source, client.epoch}, client.highest_decided, now);
  state_changed_ = true;
}

// Megabytes are taken from those only who have said that they are there.
void Service::bring(Brought brought) {
  Payload& payload = brought.payload;
  if (const auto refusal = writers_.refuse({payload.source, payload.epoch, 0}, brought.sender))
    return payloads_.answer(payload, PayloadAnswer::kBusy, refusal->reason);
  if (!brought.fault.empty())
    return payloads_.answer(payload, PayloadAnswer::kRefused, std::move(brought.fault));
  payloads_.take(std::move(payload));
}

void Service::part(const Lost& lost) {
  const auto owner = writers_.owners().find(lost.source);
  if (owner != writers_.owners().end() && owner->second.writer == lost.writer)
    refill_.give_up({lost.source, owner->second.state.epoch});
  if (const auto stranger = writers_.lose(lost.source, lost.writer)) let_strangers_go({*stranger});
  state_changed_ = true;
}

// Tells of the damage again: at the start nobody has listened yet.
void Service::end_refill() {
  if (!refill_.end(Refill::Clock::now())) return;
  announce(Severity::kInfo, "refilled",
           "clients have sent again what they keep; serving goes on. " + damage_,
           journal_.head().revision);
  state_changed_ = true;
  if (needs_solve()) return;
  for (const Command& command : std::exchange(awaiting_solution_, {})) carry_out(command);
}

// Nothing is kept of those of whom the journal has nothing.
void Service::let_strangers_go(const std::vector<Writers::Spool>& spools) {
  for (const auto& [source, epoch] : spools) {
    transport_.publish_receipts(sequencer_.turn_away_stranger(source, journal_.head().revision));
    changed_spools_.erase({source, epoch});
    payloads_.forget({source, epoch});
    transport_.forget(source, epoch);
  }
}

}  // namespace cairn
