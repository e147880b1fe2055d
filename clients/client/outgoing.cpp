// SPDX-License-Identifier: BSD-3-Clause
#include "clients/client/outgoing.hpp"

#include <algorithm>
#include <utility>

#include "idl/convert.hpp"

namespace cairn {

void Outgoing::rewind(std::uint64_t decided) {
  in_flight_.clear();
  decided_ = decided;
  next_to_send_ = decided + 1;
}

std::optional<std::uint64_t> Outgoing::next(std::uint64_t last_spooled) const {
  // The slot's last tenant must be decided: its receipt lies in a slot that is used again as well.
  if (next_to_send_ > last_spooled || next_to_send_ > decided_ + wire::kSlots) return std::nullopt;
  return next_to_send_;
}

void Outgoing::hear(Clock::time_point now) {
  heard_ = now;
  patience_ = kFirstPatience;
}

void Outgoing::sent(Transaction transaction, Clock::time_point now) {
  if (in_flight_.empty()) hear(now);
  in_flight_[next_to_send_++] = {.transaction = std::move(transaction)};
}

std::vector<const Transaction*> Outgoing::due(Clock::time_point now) {
  std::vector<const Transaction*> transactions;
  const bool silence = !in_flight_.empty() && now >= silent_until();
  if (silence) {
    heard_ = now;
    patience_ = std::min(2 * patience_, kLastPatience);
  }
  for (auto& [sequence, flight] : in_flight_) {
    if (flight.retry_at ? *flight.retry_at > now : !silence) continue;
    flight.retry_at.reset();
    transactions.push_back(&flight.transaction);
  }
  return transactions;
}

std::optional<Outgoing::Clock::time_point> Outgoing::next_retry() const {
  std::optional<Clock::time_point> earliest;
  if (!in_flight_.empty()) earliest = silent_until();
  for (const auto& [sequence, flight] : in_flight_)
    if (flight.retry_at && (!earliest || *flight.retry_at < *earliest)) earliest = flight.retry_at;
  return earliest;
}

void Outgoing::postpone(std::uint64_t sequence, Clock::time_point now) {
  const auto found = in_flight_.find(sequence);
  if (found == in_flight_.end()) return;
  const auto pause = backoff_.first * (1 << std::min(found->second.attempts++, 16));
  found->second.retry_at = now + std::min<std::chrono::milliseconds>(pause, backoff_.most);
}

bool Outgoing::is_final(const Receipt& receipt) {
  return !receipt.refusal ||
         (!is_retryable(*receipt.refusal) && *receipt.refusal != RefusalCode::kForeignSource);
}

bool Outgoing::receive(const Receipt& receipt, Clock::time_point now) {
  hear(now);
  if (!is_final(receipt)) {
    postpone(receipt.key.sequence, now);
    return false;
  }
  if (in_flight_.erase(receipt.key.sequence) == 0) return false;
  decided_ = (in_flight_.empty() ? next_to_send_ : in_flight_.begin()->first) - 1;
  return true;
}

}  // namespace cairn
