// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "cairn/graph/transaction.hpp"

namespace cairn {

/// Which sequence goes out next: the window of 256 slots and the retries. No threads, no disk, no
/// network: a value that the client's engine keeps under its lock.
class Outgoing {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kFirstPatience{1000}, kLastPatience{10'000};
  struct Backoff {
    std::chrono::milliseconds first, most;
  };

  Outgoing(std::uint64_t next_sequence, Backoff backoff)
      : next_to_send_(next_sequence), decided_(next_sequence - 1), backoff_(backoff) {}

  /// Every sequence up to this one has its final receipt, or was decided before this run.
  [[nodiscard]] std::uint64_t decided() const { return decided_; }

  /// Go on after `decided`; what was in flight is forgotten and will be sent again.
  void rewind(std::uint64_t decided);
  /// The next one to send, if a slot is free and the spool has it.
  [[nodiscard]] std::optional<std::uint64_t> next(std::uint64_t last_spooled) const;
  /// next() was sent.
  void sent(Transaction transaction, Clock::time_point now);
  /// Those whose time to be tried again has come. All in flight where nothing was heard for a
  /// second, later for two, four, up to ten: what the middleware loses between two daemons is sent
  /// again.
  [[nodiscard]] std::vector<const Transaction*> due(Clock::time_point now);
  [[nodiscard]] std::optional<Clock::time_point> next_retry() const;

  /// This one, in flight, is to be tried again later: later each time.
  void postpone(std::uint64_t sequence, Clock::time_point now);
  /// False where the sequence stays open and is offered again: after a retryable refusal, and while
  /// another program lives under our name.
  [[nodiscard]] static bool is_final(const Receipt& receipt);
  /// A receipt has come. True where it decides a sequence that was in flight.
  bool receive(const Receipt& receipt, Clock::time_point now);

 private:
  [[nodiscard]] Clock::time_point silent_until() const { return heard_ + patience_; }
  void hear(Clock::time_point now);

  struct InFlight {
    Transaction transaction;
    int attempts = 0;
    std::optional<Clock::time_point> retry_at{};
  };

  std::map<std::uint64_t, InFlight> in_flight_;
  std::uint64_t next_to_send_;
  std::uint64_t decided_;
  Backoff backoff_;
  Clock::time_point heard_{};  ///< last receipt, or since something is in flight
  std::chrono::milliseconds patience_ = kFirstPatience;
};

}  // namespace cairn
