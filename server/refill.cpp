// SPDX-License-Identifier: BSD-3-Clause
#include "server/refill.hpp"

namespace cairn {
namespace {

constexpr std::size_t kMostSpools = 1024;  // then nobody new is waited for: names can be invented

}  // namespace

void Refill::begin(Clock::time_point now) {
  const Clock::duration spent = spent_ + (active_ ? now - began_ : Clock::duration{});
  if (spent >= patience_.in_all) return;
  spent_ = spent;
  active_ = true;
  began_ = progress_ = now;
}

void Refill::expect(const Spool& spool, std::uint64_t sequence, Clock::time_point now) {
  if (given_up_.contains(spool) || given_up_.size() + expected_.size() >= kMostSpools) return;
  if (!active_) begin(now);
  if (!active_) return;
  std::uint64_t& last = expected_[spool];
  if (sequence <= last) return;
  last = sequence;
  progress_ = now;
}

void Refill::decided(const TransactionKey& key, Clock::time_point now) {
  const auto expected = expected_.find({key.source, key.epoch});
  if (expected == expected_.end()) return;
  progress_ = now;
  if (key.sequence >= expected->second) expected_.erase(expected);
}

bool Refill::end(Clock::time_point now) {
  if (!active_) return false;
  const bool complete = expected_.empty() && now - began_ >= patience_.for_clients;
  const bool hopeless =
      now - progress_ >= patience_.for_progress || spent_ + (now - began_) >= patience_.in_all;
  if (!complete && !hopeless) return false;
  active_ = false;
  spent_ += now - began_;
  for (const auto& [spool, sequence] : expected_) given_up_.insert(spool);
  expected_.clear();
  return true;
}

std::optional<Refusal> Refill::refuse(const TransactionKey& key) const {
  if (!active_) return std::nullopt;
  const auto expected = expected_.find({key.source, key.epoch});
  if (expected != expected_.end() && key.sequence <= expected->second) return std::nullopt;
  return Refusal{RefusalCode::kBusy, "the store has lost its end, which its clients send again"};
}

}  // namespace cairn
