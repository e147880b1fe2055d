// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

#include "idl/dds/entity.hpp"

namespace cairn::dds {

/// Writes of keep-all topics, which wait for slow readers, on a thread of their own and in order. A
/// write that times out is tried again until the slow reader's lease has ended.
class Outbox {
 public:
  using Write = std::function<dds_return_t()>;
  static constexpr std::size_t kMostBytes = 256u << 20;  ///< beyond, messages are dropped and told

  ~Outbox() { stop(); }
  /// `trouble` lives until stop().
  void start(const TroubleHandler& trouble);
  /// Writes what is queued, for at most a second, and ends.
  void stop() noexcept;
  void push(std::size_t bytes, Write write);

 private:
  struct Item {
    std::size_t bytes;
    Write write;
  };
  void run();
  dds_return_t write(const Write& write);

  const TroubleHandler* trouble_ = nullptr;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> queue_;
  std::size_t bytes_ = 0;
  bool stopping_ = false;
  std::chrono::steady_clock::time_point give_up_{};
  std::thread thread_;
};

}  // namespace cairn::dds
