// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/core/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <optional>
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

/// Items [first, last) that nobody has begun, on a cache line of their own.
class alignas(64) ItemRange {
 public:
  void set(std::uint32_t first, std::uint32_t last) {
    packed_.store(std::uint64_t{last} << 32 | first, std::memory_order_release);
  }

  std::optional<std::uint32_t> take_first() {
    return take([](std::uint64_t packed) { return packed + 1; },
                [](std::uint32_t first, std::uint32_t) { return first; });
  }
  std::optional<std::uint32_t> take_last() {
    return take([](std::uint64_t packed) { return packed - (std::uint64_t{1} << 32); },
                [](std::uint32_t, std::uint32_t last) { return last - 1; });
  }

 private:
  template <class Rest, class Item>
  std::optional<std::uint32_t> take(Rest rest, Item item) {
    std::uint64_t packed = packed_.load(std::memory_order_acquire);
    while (true) {
      const auto first = static_cast<std::uint32_t>(packed);
      const auto last = static_cast<std::uint32_t>(packed >> 32);
      if (first == last) return std::nullopt;
      if (packed_.compare_exchange_weak(packed, rest(packed), std::memory_order_acq_rel,
                                        std::memory_order_acquire))
        return item(first, last);
    }
  }

  std::atomic<std::uint64_t> packed_{0};  // last << 32 | first
};

}  // namespace

struct ThreadPool::State {
  explicit State(std::size_t threads) : parts(threads) {}

  std::vector<ItemRange> parts;  ///< by thread; the first is the caller's
  std::vector<std::jthread> workers;
  alignas(64) std::atomic<std::uint32_t> generation{0};  ///< of runs; workers sleep on it
  std::atomic<bool> stopping{false};
  // Of the current run; they stay until its last claimed item is finished.
  const std::function<void(std::size_t)>* body = nullptr;
  alignas(64) std::atomic<std::uint32_t> unfinished{0};

  // Who has finished its own part takes from the far ends of the others': so a thread meets about
  // the same items, and finds them in its cache, in run after run.
  void drain(std::size_t self) {
    std::uint32_t done = 0;
    while (const auto item = parts[self].take_first()) {
      (*body)(*item);
      ++done;
    }
    for (std::size_t i = 1; i < parts.size(); ++i) {
      while (const auto item = parts[(self + i) % parts.size()].take_last()) {
        (*body)(*item);
        ++done;
      }
    }
    if (done > 0 && unfinished.fetch_sub(done, std::memory_order_acq_rel) == done)
      unfinished.notify_one();
  }

  void work(std::size_t self) {
    std::uint32_t seen = 0;
    while (true) {
      wait_while_equal(generation, seen);
      seen = generation.load(std::memory_order_acquire);
      if (stopping) return;
      drain(self);
    }
  }
};

ThreadPool::ThreadPool(int threads) : state_(std::make_unique<State>(std::max(threads, 1))) {
  for (std::size_t i = 1; i < state_->parts.size(); ++i)
    state_->workers.emplace_back([state = state_.get(), i] { state->work(i); });
}

ThreadPool::~ThreadPool() {
  state_->stopping = true;
  state_->generation.fetch_add(1);
  state_->generation.notify_all();
  state_->workers.clear();  // joins before the atomics they wait on go away
}

int ThreadPool::threads() const { return static_cast<int>(state_->parts.size()); }

void ThreadPool::run(std::size_t count, const std::function<void(std::size_t)>& body) {
  if (state_->workers.empty() || count < 2) {
    for (std::size_t i = 0; i < count; ++i) body(i);
    return;
  }
  CAIRN_CHECK(count <= std::numeric_limits<std::uint32_t>::max(), "too many items for one run");
  const std::size_t parts = state_->parts.size();
  state_->body = &body;
  state_->unfinished.store(static_cast<std::uint32_t>(count), std::memory_order_relaxed);
  for (std::size_t i = 0; i < parts; ++i) {
    state_->parts[i].set(static_cast<std::uint32_t>(count * i / parts),
                         static_cast<std::uint32_t>(count * (i + 1) / parts));
  }
  state_->generation.fetch_add(1, std::memory_order_release);
  state_->generation.notify_all();
  state_->drain(0);
  for (std::uint32_t left = state_->unfinished.load(std::memory_order_acquire); left > 0;
       left = state_->unfinished.load(std::memory_order_acquire))
    wait_while_equal(state_->unfinished, left);
}

}  // namespace cairn
