// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>

namespace cairn {

/// Says what is wrong with a stream without flooding: each kind at once, then at most every ten
/// seconds, with how often it has been. Any thread.
class Complaints {
 public:
  using Clock = std::chrono::steady_clock;
  using Sink = std::function<void(const std::string&)>;
  static constexpr std::chrono::seconds kPause{10};

  explicit Complaints(Sink sink) : sink_(std::move(sink)) {}

  /// `kind` is one of few constant words.
  void add(const char* kind, const std::string& text, Clock::time_point now = Clock::now()) {
    const std::lock_guard lock(mutex_);
    auto& [count, told] = kinds_[kind];
    ++count;
    if (count > 1 && now - told < kPause) return;
    told = now;
    sink_(count == 1 ? text : text + " (" + std::to_string(count) + " times so far)");
  }

 private:
  struct Kind {
    std::uint64_t count = 0;
    Clock::time_point told{};
  };
  Sink sink_;
  std::mutex mutex_;
  std::map<std::string, Kind> kinds_;
};

}  // namespace cairn
