// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "clients/client/payload_spool.hpp"
#include "idl/link.hpp"

namespace cairn {

/// Brings payloads to the daemon, from the disk, on a thread of its own: at most 16 at a time, each
/// until it is stored. Any thread may call it.
class PayloadSender {
 public:
  using Tell = std::function<void(Error)>;

  /// `link` and what `tell` uses live until stop().
  PayloadSender(PayloadSpool spool, Link::Identity identity, Link& link, Tell tell)
      : spool_(std::move(spool)),
        identity_(std::move(identity)),
        link_(link),
        tell_(std::move(tell)) {}
  ~PayloadSender() { stop(); }

  void start();
  void stop();
  /// On disk when it returns.
  Result<ContentHash> take(const std::string& type, const std::string& bytes);
  /// A daemon is there that was not: everything is sent again.
  void meet_daemon();
  void receive(const PayloadReceipt& receipt);
  /// Taken and not yet stored.
  [[nodiscard]] std::uint64_t waiting() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Flight {
    Clock::time_point send_at{};
    int attempts = 0;
  };
  using Lock = std::unique_lock<std::mutex>;

  void run();
  [[nodiscard]] std::uint64_t window_end() const;
  void send(std::uint64_t number, Lock& lock);

  PayloadSpool spool_;
  Link::Identity identity_;
  Link& link_;
  Tell tell_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::uint64_t, Flight> flights_;
  bool daemon_is_there_ = false;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace cairn
