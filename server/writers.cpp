// SPDX-License-Identifier: BSD-3-Clause
#include "server/writers.hpp"

#include <algorithm>

namespace cairn {
namespace {

constexpr std::int64_t kPeriodNs = 60'000'000'000;

}  // namespace

void ClockOffset::add(std::int64_t sent_ns, std::int64_t arrived_ns) {
  if (newest_ && arrived_ns - period_began_ns_ >= kPeriodNs) {
    before_ = newest_;
    newest_.reset();
  }
  if (!newest_) period_began_ns_ = arrived_ns;
  const std::int64_t difference = sent_ns - arrived_ns;  // the offset, less the delay
  newest_ = newest_ ? std::max(*newest_, difference) : difference;
}

std::optional<std::int64_t> ClockOffset::value_ns() const {
  if (newest_ && before_) return std::max(*newest_, *before_);
  return newest_ ? newest_ : before_;
}

void Writers::hear_of(const Spool& spool) {
  if (const auto place = place_of_.find(spool); place != place_of_.end())
    return strangers_.splice(strangers_.end(), strangers_, place->second);
  if (highest_decided_(spool) > 0) return;
  place_of_[spool] = strangers_.insert(strangers_.end(), spool);
}

void Writers::forget(const Spool& spool) {
  if (const auto place = place_of_.find(spool); place != place_of_.end()) {
    strangers_.erase(place->second);
    place_of_.erase(place);
  }
  const auto owner = owners_.find(spool.first);
  if (owner != owners_.end() && owner->second.state.epoch == spool.second) owners_.erase(owner);
}

bool Writers::arrive(const ClientState& client, const Sender& sender) {
  const Spool spool{client.source, client.epoch};
  hear_of(spool);
  Owner& owner = owners_[client.source];
  const bool precedes = client.epoch != owner.state.epoch && highest_decided_(spool) > 0 &&
                        highest_decided_({client.source, owner.state.epoch}) == 0;
  if (owner.alive && owner.writer != sender.writer && !precedes) return false;
  if (owner.writer != sender.writer) owner.clock = {};
  owner.state = client;
  owner.writer = sender.writer;
  owner.alive = true;
  if (client.sent_ns != 0) owner.clock.add(client.sent_ns, sender.arrived_ns);
  return true;
}

std::optional<Refusal> Writers::refuse(const TransactionKey& key, const Sender& sender) {
  hear_of({key.source, key.epoch});
  const auto owner = owners_.find(key.source);
  if (owner == owners_.end() || !owner->second.alive)
    return Refusal{RefusalCode::kBusy, "the client has not said yet that it is there"};
  if (owner->second.writer == sender.writer) return std::nullopt;
  if (owner->second.state.epoch == key.epoch)
    return Refusal{RefusalCode::kBusy,
                   "another program has this spool; it is gone when its lease has ended"};
  return Refusal{RefusalCode::kForeignSource,
                 "another program lives under this source name; end it, or take another name"};
}

std::optional<Writers::Spool> Writers::lose(const std::string& source, std::uint64_t writer) {
  const auto owner = owners_.find(source);
  if (owner == owners_.end() || owner->second.writer != writer) return std::nullopt;
  owner->second.alive = false;
  const Spool spool{source, owner->second.state.epoch};
  if (highest_decided_(spool) > 0) return std::nullopt;
  forget(spool);
  return spool;
}

std::vector<Writers::Spool> Writers::remove_excess_strangers() {
  std::vector<Spool> gone;
  while (strangers_.size() > most_strangers_) {
    const Spool oldest = strangers_.front();
    if (highest_decided_(oldest) > 0) {  // it is known by now
      strangers_.pop_front();
      place_of_.erase(oldest);
      continue;
    }
    forget(oldest);
    gone.push_back(oldest);
  }
  return gone;
}

}  // namespace cairn
