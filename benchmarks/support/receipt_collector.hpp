// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

#include "clients/client/client.hpp"

namespace cairn::bench {

/// Waits for receipts on a thread of its own, in the order of submission.
class ReceiptCollector {
 public:
  /// Called on that thread, up to a minute later.
  using Then = std::function<void(const Result<Receipt>&)>;

  ~ReceiptCollector() { finish(); }

  /// Waits while a thousand others wait.
  void add(Submission submission, Then then) {
    std::unique_lock lock(mutex_);
    room_.wait(lock, [this] { return waiting_.size() < 1000; });
    waiting_.emplace_back(std::move(submission), std::move(then));
    more_.notify_one();
  }
  /// Returns after the last one.
  void finish() {
    {
      const std::lock_guard lock(mutex_);
      done_ = true;
    }
    more_.notify_one();
    if (thread_.joinable()) thread_.join();
  }

 private:
  void run() {
    std::unique_lock lock(mutex_);
    while (true) {
      more_.wait(lock, [this] { return done_ || !waiting_.empty(); });
      if (waiting_.empty()) return;
      auto [submission, then] = std::move(waiting_.front());
      waiting_.pop_front();
      lock.unlock();
      room_.notify_one();
      then(submission.wait(std::chrono::minutes(1)));
      lock.lock();
    }
  }

  std::mutex mutex_;
  std::condition_variable more_, room_;
  std::deque<std::pair<Submission, Then>> waiting_;
  bool done_ = false;
  std::thread thread_{[this] { run(); }};
};

}  // namespace cairn::bench
