// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <charconv>
#include <map>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "cairn/history/order.hpp"
#include "clients/client/client.hpp"

namespace cairn::test {

/// Operators who order without end, each on a thread, whoever serves: factors off and on, loops
/// trusted, records and sources' latest undone, with what stands on them too, and orders undone.
/// What is answered is promised. An order that nobody answers is asked again and again, also of the
/// next daemon.
class RestlessOperators {
 public:
  /// By record: what was asked.
  using Promises = std::map<std::uint64_t, std::string>;

  RestlessOperators(std::uint32_t domain, std::uint64_t seed, int count,
                    std::vector<std::string> sources)
      : sources_(std::move(sources)) {
    for (int i = 0; i < count; ++i)
      threads_.emplace_back([this, domain, seed, i] { run(domain, seed + 1 + i); });
  }
  ~RestlessOperators() { stop(); }

  /// Records up to this one are there to be changed.
  void may_touch(std::uint64_t records) { records_ = records; }
  void stop() {
    ending_ = true;
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }
  [[nodiscard]] Promises promises() {
    const std::lock_guard lock(mutex_);
    return promises_;
  }

 private:
  using Random = std::mt19937_64;
  static std::uint64_t draw(Random& random, std::uint64_t first, std::uint64_t last) {
    return std::uniform_int_distribution<std::uint64_t>(first, last)(random);
  }

  void run(std::uint32_t domain, std::uint64_t seed) {
    Random random(seed);
    Client client = *Client::connect({.domain = domain});
    std::uint64_t last_order = 1;
    while (!ending_) {
      std::this_thread::sleep_for(std::chrono::milliseconds(draw(random, 20, 200)));
      if (records_ < 40) continue;
      const Question question = next_question(random, last_order);
      if (const std::uint64_t record = order(client, question)) last_order = record;
    }
  }

  Question next_question(Random& random, std::uint64_t last_order) const {
    const std::uint64_t records = records_, any = draw(random, 1, records);
    const auto edge = [](const char* verb, const std::string& factor) {
      Question question{verb};
      question.options["factors"] = std::vector<std::string>{factor};
      return question;
    };
    switch (draw(random, 0, 7)) {
      case 0:
      case 1:  // a step's odometry, a loop of it, or what is false
        return edge("edge disable", std::to_string(any) + ':' + std::to_string(any % 3));
      case 2:
        return edge("edge enable", std::to_string(any));
      case 3:  // mostly refused: others stand on it
        return {"undo", {{"record", any}, {"cascade", false}}};
      case 4:
        return {"undo", {{"record", draw(random, records - 20, records)}, {"cascade", true}}};
      case 5:
        return edge(any % 2 == 0 ? "edge trust" : "edge doubt", std::to_string(any));
      case 6:
        return {"revoke",
                {{"source", sources_[any % sources_.size()]},
                 {"since", std::to_string(draw(random, records - 20, records))},
                 {"cascade", true}}};
      default:
        return {"undo", {{"record", last_order}, {"cascade", false}}};
    }
  }

  // Its record; 0 where nothing was ordered.
  std::uint64_t order(Client& client, const Question& question) {
    Question told = question;
    told.options["operator"] = "anna";
    told.options["reason"] = "she cannot leave it alone";
    const auto answer = client.command(told.to_string(), std::chrono::seconds(5));
    if (!answer) return 0;
    constexpr std::string_view kRecord = ", record ";
    const std::size_t at = answer->rfind(kRecord);
    if (at == std::string::npos) return 0;  // it was so already
    std::uint64_t record = 0;
    std::from_chars(answer->data() + at + kRecord.size(), answer->data() + answer->size(), record);
    const std::lock_guard lock(mutex_);
    promises_.emplace(record, question.to_string());
    return record;
  }

  const std::vector<std::string> sources_;  ///< whose transactions may be revoked
  std::atomic<std::uint64_t> records_{0};
  std::atomic<bool> ending_{false};
  std::mutex mutex_;
  Promises promises_;
  std::vector<std::thread> threads_;
};

}  // namespace cairn::test
