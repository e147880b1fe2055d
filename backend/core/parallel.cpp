// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/core/parallel.hpp"

#include <atomic>
#include <limits>
#include <thread>
#include <vector>

#include "cairn/core/check.hpp"

namespace cairn {

// To wake a thread takes as long as the linearization of a thousand edges, so whoever waits looks
// again and again for a while before it sleeps: workers for the next run (the two of one
// linearization follow each other at once), the caller for the last items. The caller waits for
// items that somebody has begun, never for a worker that the machine has no time for.
namespace {

/// Tells the processor that this is a waiting loop.
void relax() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

constexpr int kLooksBeforeSleep = 2000;  ///< some 30 to 100 microseconds

/// Sleeps until `value` is no longer `old`, but not before it has looked for a while.
void wait_while_equal(const std::atomic<std::uint32_t>& value, std::uint32_t old) {
  for (int look = 0; look < kLooksBeforeSleep; ++look) {
    if (value.load(std::memory_order_acquire) != old) return;
    relax();
  }
  value.wait(old, std::memory_order_acquire);
}

/// Where a thread takes its items. Half of the threads begin at the other end, so that with two
/// threads each meets about the same items, and finds them in its cache, in run after run.
enum class End { kFirst, kLast };

constexpr std::uint64_t pack(std::uint32_t first, std::uint32_t last) {
  return std::uint64_t{last} << 32 | first;
}

}  // namespace

struct ThreadPool::State {
  std::vector<std::jthread> workers;
  std::atomic<std::uint32_t> generation{0};  ///< of runs; workers sleep on it
  std::atomic<bool> stopping{false};
  std::atomic<std::uint64_t> unclaimed{0};  ///< items [first, last): last << 32 | first
  std::atomic<std::uint32_t> unfinished{0};
  // Of the current run; they stay until its last claimed item is finished.
  const std::function<void(std::size_t)>* body = nullptr;

  void drain(End end) {
    std::uint64_t range = unclaimed.load(std::memory_order_acquire);
    while (true) {
      const auto first = static_cast<std::uint32_t>(range);
      const auto last = static_cast<std::uint32_t>(range >> 32);
      if (first == last) return;
      const std::uint64_t rest = end == End::kFirst ? pack(first + 1, last) : pack(first, last - 1);
      if (!unclaimed.compare_exchange_weak(range, rest, std::memory_order_acq_rel,
                                           std::memory_order_acquire))
        continue;
      (*body)(end == End::kFirst ? first : last - 1);
      if (unfinished.fetch_sub(1, std::memory_order_acq_rel) == 1) unfinished.notify_one();
      range = unclaimed.load(std::memory_order_acquire);
    }
  }

  void work(End end) {
    std::uint32_t seen = 0;
    while (true) {
      wait_while_equal(generation, seen);
      seen = generation.load(std::memory_order_acquire);
      if (stopping) return;
      drain(end);
    }
  }
};

ThreadPool::ThreadPool(int threads) : state_(std::make_unique<State>()) {
  for (int i = 1; i < threads; ++i) {
    state_->workers.emplace_back(
        [state = state_.get(), i] { state->work(i % 2 == 0 ? End::kFirst : End::kLast); });
  }
}

ThreadPool::~ThreadPool() {
  state_->stopping = true;
  state_->generation.fetch_add(1);
  state_->generation.notify_all();
  state_->workers.clear();  // joins before the atomics they wait on go away
}

int ThreadPool::threads() const { return 1 + static_cast<int>(state_->workers.size()); }

void ThreadPool::run(std::size_t count, const std::function<void(std::size_t)>& body) {
  if (state_->workers.empty() || count < 2) {
    for (std::size_t i = 0; i < count; ++i) body(i);
    return;
  }
  CAIRN_CHECK(count <= std::numeric_limits<std::uint32_t>::max(), "too many items for one run");
  const auto items = static_cast<std::uint32_t>(count);
  state_->body = &body;
  state_->unfinished.store(items, std::memory_order_relaxed);
  state_->unclaimed.store(pack(0, items), std::memory_order_release);
  state_->generation.fetch_add(1, std::memory_order_release);
  state_->generation.notify_all();
  state_->drain(End::kFirst);
  for (std::uint32_t left = state_->unfinished.load(std::memory_order_acquire); left > 0;
       left = state_->unfinished.load(std::memory_order_acquire))
    wait_while_equal(state_->unfinished, left);
}

}  // namespace cairn
