// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>

#include "cairn/history/question.hpp"
#include "server/transport.hpp"

namespace cairn {

/// Answers what operators ask of a running daemon (log, show, diff, export, backup), one question
/// after the other, on a thread of its own: reading a long journal must not hold up transactions.
class CommandDesk {
 public:
  /// Both must outlive the desk.
  CommandDesk(const Journal& journal, Transport& transport)
      : journal_(journal), transport_(transport) {}
  ~CommandDesk() { stop(); }
  CommandDesk(const CommandDesk&) = delete;
  CommandDesk& operator=(const CommandDesk&) = delete;

  /// `map` is the head now. A repeated question is answered once, or with the same words.
  void take(const Command& command, const PoseGraph& map);
  /// True, and the answer said again, where this was answered; for those whom others answer.
  bool repeat(const CommandKey& key);
  /// Sends an answer of somebody else, and keeps it for repeat().
  void answer(const Reply& reply);
  /// Abandons what is not answered yet. False where that takes longer than `patience`.
  bool stop(std::optional<std::chrono::milliseconds> patience = {});

 private:
  struct Open {
    Command command;
    PoseGraph map;
  };

  void run();
  [[nodiscard]] Reply answer_one(const Open& open) const;
  void remember(const Reply& reply);

  const Journal& journal_;
  Transport& transport_;
  std::mutex mutex_;  // guards what follows
  std::condition_variable wake_;
  std::deque<Open> open_;  ///< the first one is being answered
  std::deque<Reply> answered_;
  bool busy_ = false;
  std::thread thread_;
  std::atomic<bool> stopping_{false};
};

}  // namespace cairn
