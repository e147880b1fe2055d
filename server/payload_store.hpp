// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "cairn/journal/journal.hpp"
#include "server/transport.hpp"

namespace cairn {

/// Keeps payloads in the journal's store and answers for them, on a thread of its own: nobody waits
/// for megabytes to be synced. Asks for those that accepted transactions name and nobody has sent,
/// deletes those that none has named for days.
class PayloadStore {
 public:
  using Spool = std::pair<std::string, std::uint64_t>;  ///< source and epoch
  struct Options {
    std::size_t queue_bytes = 128u << 20;      ///< beyond, payloads are `busy`
    std::chrono::milliseconds patience{2000};  ///< until a missing one is asked for
    std::chrono::milliseconds ask_again{10'000};
    int questions = 6;             ///< then it is given up
    std::size_t missing = 10'000;  ///< asked for at a time
    /// Those that no transaction names are kept so long: theirs may still be on its way.
    std::chrono::milliseconds keep_unnamed{std::chrono::hours(7 * 24)};
    std::chrono::milliseconds collect_every{std::chrono::hours(24)};
  };
  using Tell = std::function<void(Severity, const std::string& text)>;

  /// `tell` and, after each payload that is on disk now, `stored` are called from the store's
  /// thread.
  PayloadStore(Journal& journal, Transport& transport, Options options, Tell tell,
               std::function<void()> stored = {})
      : journal_(journal),
        transport_(transport),
        options_(options),
        tell_(std::move(tell)),
        tell_stored_(std::move(stored)) {}
  ~PayloadStore() { stop(); }

  void start();
  void stop();
  /// From any thread.
  void take(Payload payload);
  /// An accepted transaction of this spool names the payload. From any thread.
  void expect(const Spool& spool, const ContentHash& hash);
  /// What waits of this spool is not stored, and no answer to it is kept. From any thread.
  void forget(const Spool& spool);
  /// What waits to be stored: how many, and their bytes. From any thread.
  [[nodiscard]] std::pair<std::size_t, std::size_t> waiting() const {
    const std::lock_guard lock(mutex_);
    return {queue_.size(), queued_bytes_};
  }
  /// From any thread.
  void answer(const Payload& payload, PayloadAnswer answer, std::string reason = {});

 private:
  using Clock = std::chrono::steady_clock;
  struct Missing {
    Spool spool;
    Clock::time_point ask_at;
    int questions = 0;
  };
  using Lock = std::unique_lock<std::mutex>;

  void run();
  void store(const Payload& payload);
  void ask(Lock& lock);
  void collect(Lock& lock);

  Journal& journal_;
  Transport& transport_;
  Options options_;
  Tell tell_;
  std::function<void()> tell_stored_;
  Clock::time_point collect_at_{};  ///< of the thread; first at its start

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  std::deque<Payload> queue_;
  std::size_t queued_bytes_ = 0;
  std::optional<Spool> storing_;  ///< whose payload is being stored; nobody's once forgotten
  std::map<ContentHash, Missing> missing_;
  std::set<ContentHash> stored_;  ///< in this run, the last thousands: need not be looked up
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace cairn
