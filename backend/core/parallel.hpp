// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace cairn {

/// A fixed set of worker threads that share index ranges. One thread at a time may call `run`.
/// Callers keep results independent of the thread count by writing each index to its own place.
class ThreadPool {
 public:
  /// `threads` counts the caller too: 1 runs everything in place and starts nothing.
  explicit ThreadPool(int threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  [[nodiscard]] int threads() const;

  /// Calls `body(i)` once for each i in [0, count), from any thread in any order; returns when all
  /// are done.
  void run(std::size_t count, const std::function<void(std::size_t)>& body);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cairn
