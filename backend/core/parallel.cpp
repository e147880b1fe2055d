// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/core/parallel.hpp"

#include <atomic>
#include <limits>
#include <thread>
#include <vector>

#include "cairn/core/check.hpp"

namespace cairn {

// Workers spin briefly before they sleep: one linearization takes tens of microseconds, a wake-up
// about as long. The caller waits for items that somebody has begun, never for a worker that the
// machine has no time for.
struct ThreadPool::State {
  std::vector<std::jthread> workers;
  std::atomic<std::uint32_t> generation{0};  ///< of runs; workers sleep on it
  std::atomic<bool> stopping{false};
  std::atomic<std::uint32_t> unclaimed{0};
  std::atomic<std::uint32_t> unfinished{0};
  // Of the current run; they stay until its last claimed item is finished.
  std::uint32_t count = 0;
  const std::function<void(std::size_t)>* body = nullptr;

  void drain() {
    std::uint32_t left = unclaimed.load(std::memory_order_acquire);
    while (left > 0) {
      if (!unclaimed.compare_exchange_weak(left, left - 1, std::memory_order_acq_rel,
                                           std::memory_order_acquire))
        continue;
      (*body)(count - left);
      if (unfinished.fetch_sub(1, std::memory_order_acq_rel) == 1) unfinished.notify_one();
      left = unclaimed.load(std::memory_order_acquire);
    }
  }

  void work() {
    std::uint32_t seen = 0;
    while (true) {
      for (int spin = 0; spin < 2000 && generation.load(std::memory_order_acquire) == seen;
           ++spin) {
      }
      generation.wait(seen, std::memory_order_acquire);
      seen = generation.load(std::memory_order_acquire);
      if (stopping) return;
      drain();
    }
  }
};

ThreadPool::ThreadPool(int threads) : state_(std::make_unique<State>()) {
  for (int i = 1; i < threads; ++i)
    state_->workers.emplace_back([state = state_.get()] { state->work(); });
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
  state_->count = static_cast<std::uint32_t>(count);
  state_->body = &body;
  state_->unfinished.store(state_->count, std::memory_order_relaxed);
  state_->unclaimed.store(state_->count, std::memory_order_release);
  state_->generation.fetch_add(1, std::memory_order_release);
  state_->generation.notify_all();
  state_->drain();
  for (std::uint32_t left = state_->unfinished.load(std::memory_order_acquire); left > 0;
       left = state_->unfinished.load(std::memory_order_acquire))
    state_->unfinished.wait(left, std::memory_order_acquire);
}

}  // namespace cairn
