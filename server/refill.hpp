// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "cairn/replay/map_head.hpp"

namespace cairn {

/// The time in which clients send again what the store has lost. Until it is over nothing else is
/// decided, so that what was promised comes first. One thread.
class Refill {
 public:
  using Clock = std::chrono::steady_clock;
  using Spool = std::pair<std::string, std::uint64_t>;  ///< source and epoch
  struct Patience {
    std::chrono::milliseconds for_clients{1000};     ///< to say what they hold
    std::chrono::milliseconds for_progress{15'000};  ///< clients that send no more are given up
    std::chrono::milliseconds in_all{120'000};       ///< of one run, however often it begins
  };

  explicit Refill(Patience patience) : patience_(patience) {}

  /// Nothing happens when all the time there is was spent before.
  void begin(Clock::time_point now);
  /// The spool had everything up to `sequence` decided; the journal has less. Who was given up once
  /// is not waited for again.
  void expect(const Spool& spool, std::uint64_t sequence, Clock::time_point now);
  /// Its client is gone.
  void give_up(const Spool& spool) { expected_.erase(spool); }
  /// The journal has it again.
  void decided(const TransactionKey& key, Clock::time_point now);

  [[nodiscard]] bool active() const { return active_; }
  /// True once, when it is over.
  [[nodiscard]] bool end(Clock::time_point now);
  /// `busy` for what is not awaited while something else is.
  [[nodiscard]] std::optional<Refusal> refuse(const TransactionKey& key) const;

 private:
  Patience patience_;
  bool active_ = false;
  std::map<Spool, std::uint64_t> expected_;
  std::set<Spool> given_up_;
  Clock::time_point began_{}, progress_{};
  Clock::duration spent_{};  ///< before it began
};

}  // namespace cairn
