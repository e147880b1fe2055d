// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/core/parallel.hpp"

#include <atomic>
#include <thread>
#include <vector>

namespace cairn {

// Workers spin briefly before they sleep: one linearization takes tens of microseconds, a wake-up
// about as long.
struct ThreadPool::State {
  std::vector<std::jthread> workers;
  std::atomic<std::uint32_t> generation{0};
  std::atomic<bool> stopping{false};
  std::atomic<std::size_t> next{0};
  std::atomic<int> busy{0};
  std::size_t count = 0;
  const std::function<void(std::size_t)>* body = nullptr;

  void drain() {
    for (std::size_t i = next.fetch_add(1); i < count; i = next.fetch_add(1)) (*body)(i);
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
      busy.fetch_sub(1, std::memory_order_release);
      busy.notify_one();
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
  state_->count = count;
  state_->body = &body;
  state_->next = 0;
  state_->busy = static_cast<int>(state_->workers.size());
  state_->generation.fetch_add(1, std::memory_order_release);
  state_->generation.notify_all();
  state_->drain();
  for (int left = state_->busy; left > 0; left = state_->busy.load(std::memory_order_acquire)) {
    if (left > 0) state_->busy.wait(left, std::memory_order_acquire);
  }
}

}  // namespace cairn
